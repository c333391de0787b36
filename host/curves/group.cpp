#include "curves/group.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "curves/region.h"
#include "pvg/status.h"
#include "scene/color.h"

namespace pvg {
namespace {

using Row = Eigen::RowVectorXd;

/// Values of one channel group along a curve, colours already in the space of diffusion.
struct CurveValues {
    Stops<Color> color;
    Stops<double> height;

    bool empty() const { return color.empty() && height.empty(); }
    Row at(double t, bool closed) const {
        if (color.empty())
            return Row::Constant(1, evaluate_stops(height, t, closed));
        return evaluate_stops(color, t, closed).transpose();
    }
    std::size_t count() const { return color.empty() ? height.t.size() : color.t.size(); }
    const std::vector<double>& stops() const { return color.empty() ? height.t : color.t; }
    Row stop(std::size_t k) const { return color.empty() ? Row::Constant(1, height.value[k]) : Row(color.value[k].transpose()); }
    double largest() const {
        double most = 0;
        for (std::size_t k = 0; k < count(); ++k) most = std::max(most, stop(k).cwiseAbs().maxCoeff());
        return most;
    }
};

CurveValues side_values(const SideValues& side, Quantity quantity, ColorSpace space) {
    CurveValues values;
    if (quantity == Quantity::height) {
        values.height = side.height;
    } else {
        values.color = side.color;
        for (Color& c : values.color.value) c = to_diffusion_space(c, space);
    }
    return values;
}

CurveValues jump_values(const PoissonCurve& curve, Quantity quantity) {
    CurveValues values;
    if (quantity == Quantity::height)
        values.height = curve.height_jump;
    else
        values.color = curve.color_jump;
    return values;
}

const char* noun(Quantity quantity) { return quantity == Quantity::color ? "colour" : "height"; }

/// What a primitive is to the group.
struct Role {
    int drawn = none;
    CurveValues left, right;  // diffusion curve
    CurveValues jump;         // Poisson curve
    std::vector<ChainEdge> edges;
};

[[noreturn]] void refuse_unreached(const DrawnPrimitive& drawn, Quantity quantity) {
    throw Error(ErrorKind::bad_input, drawn.where + ": " + drawn.primitive->name() +
                                          " needs at least one diffusion curve that gives a " + noun(quantity) +
                                          " in its layer and on its part of the surface");
}

class GroupMaker {
public:
    GroupMaker(const Drawing& drawing, Group& group, ColorSpace space, Warnings& warnings)
        : drawing_(drawing), surface_(drawing.imprinted.surface), group_(group), warnings_(warnings) {
        for (int p = 0; p < static_cast<int>(drawing.primitives.size()); ++p) {
            const DrawnPrimitive& drawn = drawing.primitives[p];
            if (drawn.layer != group.layer)
                continue;
            Role role;
            role.drawn = p;
            if (const auto* dc = std::get_if<DiffusionCurve>(&drawn.primitive->shape)) {
                role.left = side_values(dc->left, group.quantity, space);
                role.right = side_values(dc->right, group.quantity, space);
                if (role.left.empty() && role.right.empty())
                    continue;
                role.edges = chain_edges(surface_, drawn.chain);
                diffusion_curves_.push_back(std::move(role));
            } else if (const auto* pc = std::get_if<PoissonCurve>(&drawn.primitive->shape)) {
                role.jump = jump_values(*pc, group.quantity);
                if (role.jump.empty())
                    continue;
                if (pc->width > 0) {
                    sources_.push_back(std::move(role));
                } else {
                    role.edges = chain_edges(surface_, drawn.chain);
                    poisson_curves_.push_back(std::move(role));
                }
            } else if (const auto* pr = std::get_if<PoissonRegion>(&drawn.primitive->shape)) {
                if (group.quantity == Quantity::color ? !pr->color.has_value() : !pr->height.has_value())
                    continue;
                sources_.push_back(std::move(role));
            }
        }
    }

    void run() {
        if (diffusion_curves_.empty()) {
            int first = none;  // the first primitive in the scene's order
            for (const auto* list : {&poisson_curves_, &sources_})
                if (!list->empty() && (first == none || list->front().drawn < first))
                    first = list->front().drawn;
            if (first != none)
                refuse_unreached(drawing_.primitives[first], group_.quantity);
            return;
        }
        group_.bounded = true;
        group_.slit.assign(surface_.halfedge_count(), 0);
        group_.side.assign(surface_.halfedge_count(), {});
        group_.on_curve.assign(surface_.vertex_count(), 0);
        group_.feature.assign(surface_.vertex_count(), 0);
        lay_diffusion_curves();
        lay_poisson_curves();
        cut();
        hold_values();
        couple();
        add_sources();
        reach();
    }

private:
    void lay_diffusion_curves() {
        std::set<std::pair<int, int>> overlaps;
        for (int r = 0; r < static_cast<int>(diffusion_curves_.size()); ++r) {
            const Role& role = diffusion_curves_[r];
            for (int i = 0; i < static_cast<int>(role.edges.size()); ++i) {
                const ChainEdge& edge = role.edges[i];
                for (const int h : {edge.left, edge.right}) {
                    if (h == none)
                        continue;
                    CurveSide& side = group_.side[h];
                    if (side.drawn != none && side.drawn != role.drawn)
                        overlaps.insert({role.drawn, side.drawn});
                    side = {role.drawn, i, h == edge.left};
                }
                if (edge.left != none && edge.right != none)
                    group_.slit[edge.left] = group_.slit[edge.right] = 1;
            }
            role_of_[role.drawn] = r;
            mark_on_curve(drawing_.primitives[role.drawn].chain);
        }
        for (const auto& [later, earlier] : overlaps) {
            const DrawnPrimitive& drawn = drawing_.primitives[later];
            warnings_.push_back(drawn.where + ": " + drawn.primitive->name() + " runs along " +
                                drawing_.primitives[earlier].primitive->name() + "; its own " + noun(group_.quantity) +
                                " is taken there, because it comes later");
        }

        // A vertex in the middle of one curve has two edges; anything else is a tip, a meeting or a crossing.
        std::vector<int> degree(surface_.vertex_count(), 0);
        for (int h = 0; h < surface_.halfedge_count(); ++h) {
            const int twin = surface_.twin(h);
            if (group_.side[h].drawn == none || (twin != none && twin < h))
                continue;
            ++degree[surface_.origin(h)];
            ++degree[surface_.target(h)];
        }
        for (int v = 0; v < surface_.vertex_count(); ++v) group_.feature[v] = degree[v] != 0 && degree[v] != 2;
    }

    /// Jumps across the edges of sharp Poisson curves, as seen by the vertex that a halfedge leaves: u(left of it) - u(right of
    /// it).
    void lay_poisson_curves() {
        const auto add = [&](int h, const Row& jump) {
            const auto [at, fresh] = jump_.emplace(h, jump);
            if (!fresh)
                at->second += jump;
        };
        for (const Role& role : poisson_curves_) {
            const CurveChain& chain = drawing_.primitives[role.drawn].chain;
            mark_on_curve(chain);
            const std::size_t count = chain.vertices.size();
            for (std::size_t i = 0; i < role.edges.size(); ++i) {
                const ChainEdge& edge = role.edges[i];
                if (edge.left == none || edge.right == none || group_.side[edge.left].drawn != none)
                    continue;
                group_.slit[edge.left] = group_.slit[edge.right] = 1;
                const std::size_t j = (i + 1) % count;
                add(edge.left, end_jump(role, i));
                add(edge.right, -end_jump(role, j));
            }
        }
    }

    /// J at a vertex of the chain: 0 at an end around which the surface is whole, since both sides are one there.
    Row end_jump(const Role& role, std::size_t i) {
        const DrawnPrimitive& drawn = drawing_.primitives[role.drawn];
        const CurveChain& chain = drawn.chain;
        const Row jump = role.jump.at(chain.t[i], chain.closed);
        if (chain.closed || (i != 0 && i + 1 != chain.vertices.size()))
            return jump;
        if (is_cut_open(chain.vertices[i]))
            return jump;
        if (jump.cwiseAbs().maxCoeff() > 1e-6 * role.jump.largest())
            warnings_.push_back(drawn.where + ": the " + noun(group_.quantity) + " jump of " + drawn.primitive->name() +
                                " does not fade out at t = " + (i == 0 ? "0" : "1") + ", where the curve ends; it is 0 there");
        return Row::Zero(jump.size());
    }

    /// Whether the surface border or a diffusion curve meets the vertex.
    bool is_cut_open(int vertex) const {
        const int start = surface_.outgoing(vertex);
        for (int h = start;;) {
            if (group_.side[h].drawn != none)
                return true;
            h = surface_.twin(Surface::prev(h));
            if (h == none)
                return true;
            if (h == start)
                return false;
        }
    }

    void cut() {
        group_.cut = slit_surface(surface_, group_.slit);
        // An edge between two tips cannot open: it only holds values.
        for (int h = 0; h < surface_.halfedge_count(); ++h)
            if (group_.slit[h] && group_.cut.surface.twin(h) != none) {
                group_.slit[h] = 0;
                jump_.erase(h);
            }
    }

    void hold_values() {
        const Surface& cut = group_.cut.surface;
        group_.value = Eigen::MatrixXd::Zero(cut.vertex_count(), group_.channels);
        std::vector<int> given(cut.vertex_count(), 0);
        // Each sector is bounded by at most two sides of curves, and takes the mean of the values they give.
        for (int h = 0; h < cut.halfedge_count(); ++h) {
            const CurveSide& side = group_.side[h];
            if (side.drawn == none)
                continue;
            const Role& role = diffusion_curves_[role_of_.at(side.drawn)];
            const CurveValues& values = side.left ? role.left : role.right;
            if (values.empty())
                continue;
            const CurveChain& chain = drawing_.primitives[side.drawn].chain;
            const std::size_t next = (side.edge + 1) % chain.vertices.size();
            const double at_origin = chain.t[side.left ? static_cast<std::size_t>(side.edge) : next];
            const double at_target = chain.t[side.left ? next : static_cast<std::size_t>(side.edge)];
            group_.value.row(cut.origin(h)) += values.at(at_origin, chain.closed);
            group_.value.row(cut.target(h)) += values.at(at_target, chain.closed);
            ++given[cut.origin(h)];
            ++given[cut.target(h)];
        }
        group_.dirichlet.assign(cut.vertex_count(), 0);
        for (int v = 0; v < cut.vertex_count(); ++v) {
            if (given[v] == 0)
                continue;
            group_.dirichlet[v] = 1;
            if (given[v] > 1)
                group_.value.row(v) /= given[v];
        }
    }

    /// Copies of a vertex in a stretch of its fan that no diffusion curve cuts, with u - u(first copy).
    using Arc = std::vector<std::pair<int, Row>>;

    void couple() {
        std::set<int> vertices;
        for (const auto& [h, jump] : jump_) vertices.insert(surface_.origin(h));
        for (int v : vertices) {
            std::vector<int> fan;
            const int start = surface_.outgoing(v);
            for (int h = start; h != none;) {
                fan.push_back(h);
                h = surface_.twin(Surface::prev(h));
                if (h == start)
                    break;
            }
            // Begin behind a diffusion curve where there is one, so that no stretch is met in two halves.
            if (!surface_.is_border_vertex(v))
                for (std::size_t i = 0; i < fan.size(); ++i)
                    if (group_.slit[fan[i]] && group_.side[fan[i]].drawn != none) {
                        std::rotate(fan.begin(), fan.begin() + static_cast<std::ptrdiff_t>(i), fan.end());
                        break;
                    }
            Arc arc;
            Row offset = Row::Zero(group_.channels);
            for (std::size_t i = 0; i < fan.size(); ++i) {
                const int h = fan[i];
                if (group_.slit[h] && group_.side[h].drawn != none) {
                    couple_arc(arc);
                    arc.clear();
                    offset.setZero();
                } else if (const auto jump = jump_.find(h); jump != jump_.end() && i > 0) {
                    offset += jump->second;
                }
                const int copy = group_.cut.surface.origin(h);
                if (std::none_of(arc.begin(), arc.end(), [&](const auto& entry) { return entry.first == copy; }))
                    arc.emplace_back(copy, offset);
            }
            couple_arc(arc);
        }
    }

    void couple_arc(const Arc& arc) {
        if (arc.size() < 2)
            return;
        std::vector<std::size_t> held;
        for (std::size_t i = 0; i < arc.size(); ++i)
            if (group_.dirichlet[arc[i].first])
                held.push_back(i);
        if (held.empty()) {
            for (std::size_t i = 1; i < arc.size(); ++i) group_.couplings.push_back({arc[i].first, arc[0].first, arc[i].second});
            return;
        }
        // A diffusion curve holds one side of the jump, so it holds the others too.
        for (std::size_t i = 0; i < arc.size(); ++i) {
            if (std::find(held.begin(), held.end(), i) != held.end())
                continue;
            std::size_t nearest = held[0];
            for (std::size_t j : held)
                if ((j > i ? j - i : i - j) < (nearest > i ? nearest - i : i - nearest))
                    nearest = j;
            group_.dirichlet[arc[i].first] = 1;
            group_.value.row(arc[i].first) = group_.value.row(arc[nearest].first) + arc[i].second - arc[nearest].second;
        }
    }

    void add_sources() {
        for (const Role& role : sources_) {
            const DrawnPrimitive& drawn = drawing_.primitives[role.drawn];
            mark_on_curve(drawn.chain);
            for (const CurveChain& border : drawn.borders) mark_on_curve(border);
            const auto* region = std::get_if<PoissonRegion>(&drawn.primitive->shape);
            for (const DrawnSource& source : drawn.sources) {
                if (region)
                    group_.sources.push_back({role.drawn, source.profile,
                                              group_.quantity == Quantity::color ? Row(region->color->transpose())
                                                                                 : Row::Constant(1, *region->height)});
                else if (source.stops == role.jump.stops())  // one column a stop, so that a new value needs no new profile
                    group_.sources.push_back({role.drawn, source.profile, role.jump.stop(source.stop)});
            }
        }
    }

    void reach() {
        int count = 0;
        const Surface& cut = group_.cut.surface;
        const std::vector<int> component = face_components(cut, &count);
        std::vector<int> root(count);
        for (int c = 0; c < count; ++c) root[c] = c;
        const auto find = [&](int c) {
            while (root[c] != c) c = root[c] = root[root[c]];
            return c;
        };
        const auto component_of = [&](int v) { return component[cut.outgoing(v) / 3]; };
        for (const Coupling& coupling : group_.couplings)
            root[find(component_of(coupling.left))] = find(component_of(coupling.right));
        std::vector<char> bounded(count, 0);
        for (int v = 0; v < cut.vertex_count(); ++v)
            if (group_.dirichlet[v])
                bounded[find(component_of(v))] = 1;
        group_.reached.assign(cut.face_count(), 0);
        for (int f = 0; f < cut.face_count(); ++f) group_.reached[f] = bounded[find(component[f])];

        for (const Role& role : poisson_curves_)
            for (const ChainEdge& edge : role.edges)
                for (const int h : {edge.left, edge.right})
                    if (h != none && !group_.reached[h / 3] && role.jump.largest() > 0)
                        refuse_unreached(drawing_.primitives[role.drawn], group_.quantity);
        for (const GroupSource& source : group_.sources)
            for (const auto& [face, laplacian] : source.profile)
                if (!group_.reached[face] && laplacian != 0 && !source.value.isZero(0))
                    refuse_unreached(drawing_.primitives[source.drawn], group_.quantity);
        std::erase_if(group_.couplings,
                      [&](const Coupling& coupling) { return !group_.reached[cut.outgoing(coupling.left) / 3]; });
        for (GroupSource& source : group_.sources)
            std::erase_if(source.profile, [&](const auto& entry) { return !group_.reached[entry.first]; });
        std::erase_if(group_.sources, [](const GroupSource& source) { return source.profile.empty(); });
        for (int h = 0; h < surface_.halfedge_count(); ++h)
            if (group_.slit[h] && !group_.reached[h / 3] && !group_.reached[surface_.twin(h) / 3])
                group_.slit[h] = 0;
    }

    void mark_on_curve(const CurveChain& chain) {
        for (int v : chain.vertices) group_.on_curve[v] = 1;
    }

    const Drawing& drawing_;
    const Surface& surface_;
    Group& group_;
    Warnings& warnings_;
    std::vector<Role> diffusion_curves_, poisson_curves_, sources_;
    std::map<int, int> role_of_;  // drawn -> index into diffusion_curves_
    std::map<int, Row> jump_;     // per halfedge
};

}  // namespace

Group make_group(const Drawing& drawing, int layer, Quantity quantity, ColorSpace space, Warnings& warnings) {
    Group group;
    group.layer = layer;
    group.quantity = quantity;
    group.channels = quantity == Quantity::color ? 4 : 1;
    GroupMaker(drawing, group, space, warnings).run();
    return group;
}

}  // namespace pvg
