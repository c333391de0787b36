#include "curves/group.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <type_traits>

#include "curves/controls.h"
#include "curves/region.h"
#include "pvg/status.h"
#include "scene/color.h"

namespace pvg {
namespace {

const char* noun(Quantity quantity) { return quantity == Quantity::color ? "colour" : "height"; }

/// What a primitive is to the group.
struct Role {
    int drawn = none;
    int left = none, right = none;  // diffusion curve: controls, or none where a side is open
    int jump = none;                // Poisson curve: control
    int region = none;              // Poisson region: control
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
        : drawing_(drawing), surface_(drawing.imprinted.surface), group_(group), space_(space), warnings_(warnings) {
        for (int p = 0; p < static_cast<int>(drawing.primitives.size()); ++p) {
            const DrawnPrimitive& drawn = drawing.primitives[p];
            if (drawn.layer != group.layer)
                continue;
            Role role;
            role.drawn = p;
            if (const auto* dc = std::get_if<DiffusionCurve>(&drawn.primitive->shape)) {
                role.left = add_side(drawn, ControlPart::left, dc->left);
                role.right = add_side(drawn, ControlPart::right, dc->right);
                if (role.left == none && role.right == none)
                    continue;
                role.edges = chain_edges(surface_, drawn.chain);
                diffusion_curves_.push_back(std::move(role));
            } else if (const auto* pc = std::get_if<PoissonCurve>(&drawn.primitive->shape)) {
                role.jump = group.quantity == Quantity::height ? add_control(drawn, ControlPart::jump, pc->height_jump)
                                                               : add_control(drawn, ControlPart::jump, pc->color_jump);
                if (role.jump == none)
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
                role.region = group.quantity == Quantity::color
                                  ? add_control(drawn, ControlPart::region, Stops<Color>{{0}, {*pr->color}})
                                  : add_control(drawn, ControlPart::region, Stops<double>{{0}, {*pr->height}});
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
    /// none where there is no stop.
    template <typename Value>
    int add_control(const DrawnPrimitive& drawn, ControlPart part, const Stops<Value>& stops) {
        if (stops.empty())
            return none;
        Eigen::MatrixXd value(static_cast<Eigen::Index>(stops.t.size()), group_.channels);
        for (std::size_t k = 0; k < stops.t.size(); ++k)
            if constexpr (std::is_same_v<Value, double>)
                value(static_cast<Eigen::Index>(k), 0) = stops.value[k];
            else
                value.row(static_cast<Eigen::Index>(k)) = stops.value[k].transpose();
        group_.controls.push_back(
            {drawn.primitive->pointer, part, group_.quantity, drawn.chain.closed, stops.t, std::move(value), true});
        return static_cast<int>(group_.controls.size()) - 1;
    }
    int add_side(const DrawnPrimitive& drawn, ControlPart part, const SideValues& side) {
        if (group_.quantity == Quantity::height)
            return add_control(drawn, part, side.height);
        Stops<Color> diffused = side.color;
        for (Color& color : diffused.value) color = to_diffusion_space(color, space_);
        return add_control(drawn, part, diffused);
    }
    static ControlSum at(int control, double t) { return {{control, none, t, 1}}; }

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
                add_scaled(jump_[edge.left], end_jump(role, i), 1);
                add_scaled(jump_[edge.right], end_jump(role, j), -1);
            }
        }
    }

    /// J at a vertex of the chain: 0 at an end around which the surface is whole, since both sides are one there.
    ControlSum end_jump(const Role& role, std::size_t i) {
        const DrawnPrimitive& drawn = drawing_.primitives[role.drawn];
        const CurveChain& chain = drawn.chain;
        ControlSum jump = at(role.jump, chain.t[i]);
        if (chain.closed || (i != 0 && i + 1 != chain.vertices.size()))
            return jump;
        if (is_cut_open(chain.vertices[i]))
            return jump;
        if (value_of(jump, group_.controls, group_.channels).cwiseAbs().maxCoeff() >
            1e-6 * group_.controls[role.jump].value.cwiseAbs().maxCoeff())
            warnings_.push_back(drawn.where + ": the " + noun(group_.quantity) + " jump of " + drawn.primitive->name() +
                                " does not fade out at t = " + (i == 0 ? "0" : "1") + ", where the curve ends; it is 0 there");
        return {};
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
        value_.assign(cut.vertex_count(), {});
        std::vector<int> given(cut.vertex_count(), 0);
        // Each sector is bounded by at most two sides of curves, and takes the mean of the values they give.
        for (int h = 0; h < cut.halfedge_count(); ++h) {
            const CurveSide& side = group_.side[h];
            if (side.drawn == none)
                continue;
            const Role& role = diffusion_curves_[role_of_.at(side.drawn)];
            const int values = side.left ? role.left : role.right;
            if (values == none)
                continue;
            const CurveChain& chain = drawing_.primitives[side.drawn].chain;
            const std::size_t next = (side.edge + 1) % chain.vertices.size();
            const double at_origin = chain.t[side.left ? static_cast<std::size_t>(side.edge) : next];
            const double at_target = chain.t[side.left ? next : static_cast<std::size_t>(side.edge)];
            for (const auto& [v, t] : {std::pair{cut.origin(h), at_origin}, std::pair{cut.target(h), at_target}}) {
                add_scaled(value_[v], at(values, t), 1);
                ++given[v];
            }
        }
        group_.dirichlet.assign(cut.vertex_count(), 0);
        for (int v = 0; v < cut.vertex_count(); ++v) {
            group_.dirichlet[v] = given[v] > 0;
            for (ControlTerm& term : value_[v]) term.weight /= given[v];
        }
    }

    /// Copies of a vertex in a stretch of its fan that no diffusion curve cuts, with u - u(first copy).
    using Arc = std::vector<std::pair<int, ControlSum>>;

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
            ControlSum offset;
            for (std::size_t i = 0; i < fan.size(); ++i) {
                const int h = fan[i];
                if (group_.slit[h] && group_.side[h].drawn != none) {
                    couple_arc(arc);
                    arc.clear();
                    offset.clear();
                } else if (const auto jump = jump_.find(h); jump != jump_.end() && i > 0) {
                    add_scaled(offset, jump->second, 1);
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
            ControlSum& value = value_[arc[i].first];
            value = value_[arc[nearest].first];
            add_scaled(value, arc[i].second, 1);
            add_scaled(value, arc[nearest].second, -1);
        }
    }

    void add_sources() {
        for (const Role& role : sources_) {
            const DrawnPrimitive& drawn = drawing_.primitives[role.drawn];
            mark_on_curve(drawn.chain);
            for (const CurveChain& border : drawn.borders) mark_on_curve(border);
            for (const DrawnSource& source : drawn.sources) {
                if (role.region != none)
                    group_.sources.push_back({role.drawn, source.profile, {{role.region, 0, 0, 1}}});
                else if (source.stops ==
                         group_.controls[role.jump].t)  // one column a stop, so that a new value needs no new profile
                    group_.sources.push_back({role.drawn, source.profile, {{role.jump, static_cast<int>(source.stop), 0, 1}}});
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
        for (const GroupCoupling& coupling : group_.couplings)
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
                    if (h != none && !group_.reached[h / 3])
                        must_be_zero(role.drawn, role.jump, none);
        for (const GroupSource& source : group_.sources)
            for (const auto& [face, laplacian] : source.profile)
                if (!group_.reached[face] && laplacian != 0)
                    must_be_zero(source.drawn, source.value.front().control, source.value.front().stop);
        std::erase_if(group_.couplings,
                      [&](const GroupCoupling& coupling) { return !group_.reached[cut.outgoing(coupling.left) / 3]; });
        for (int v = 0; v < cut.vertex_count(); ++v)
            if (group_.dirichlet[v])
                group_.held.emplace_back(v, std::move(value_[v]));
        for (GroupSource& source : group_.sources)
            std::erase_if(source.profile, [&](const auto& entry) { return !group_.reached[entry.first]; });
        std::erase_if(group_.sources, [](const GroupSource& source) { return source.profile.empty(); });
        for (int h = 0; h < surface_.halfedge_count(); ++h)
            if (group_.slit[h] && !group_.reached[h / 3] && !group_.reached[surface_.twin(h) / 3])
                group_.slit[h] = 0;
    }

    /// Values (of one stop, or of all) whose place no diffusion curve reaches.
    void must_be_zero(int drawn, int control, int stop) {
        Control& c = group_.controls[control];
        if (stop == none ? !c.value.isZero(0) : !c.value.row(stop).isZero(0))
            refuse_unreached(drawing_.primitives[drawn], group_.quantity);
        c.reached = false;
    }

    void mark_on_curve(const CurveChain& chain) {
        for (int v : chain.vertices) group_.on_curve[v] = 1;
    }

    const Drawing& drawing_;
    const Surface& surface_;
    Group& group_;
    const ColorSpace space_;
    Warnings& warnings_;
    std::vector<Role> diffusion_curves_, poisson_curves_, sources_;
    std::map<int, int> role_of_;      // drawn -> index into diffusion_curves_
    std::map<int, ControlSum> jump_;  // per halfedge
    std::vector<ControlSum> value_;   // per vertex of cut: what holds it
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
