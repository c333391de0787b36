#include "curves/controls.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "scene/color.h"

namespace pvg {
namespace {

struct Values {
    std::vector<double> t;
    std::vector<Eigen::RowVectorXd> value;  // over the quantity's own channels
};

template <typename Value>
Values to_values(const Stops<Value>& stops) {
    Values values{stops.t, {}};
    for (const Value& v : stops.value)
        if constexpr (std::is_same_v<Value, double>)
            values.value.push_back(Eigen::RowVectorXd::Constant(1, v));
        else
            values.value.push_back(v.transpose());
    return values;
}

template <typename Value>
Values to_values(const std::optional<Value>& value) {
    return value ? to_values(Stops<Value>{{0}, {*value}}) : Values{};
}

Values values_in(const Primitive& primitive, ControlPart part, Quantity quantity, ColorSpace space) {
    const bool color = quantity == Quantity::color;
    if (const auto* curve = std::get_if<DiffusionCurve>(&primitive.shape); curve && part <= ControlPart::right) {
        const SideValues& side = part == ControlPart::left ? curve->left : curve->right;
        if (!color)
            return to_values(side.height);
        Stops<Color> diffused = side.color;
        for (Color& c : diffused.value) c = to_diffusion_space(c, space);
        return to_values(diffused);
    }
    if (const auto* curve = std::get_if<PoissonCurve>(&primitive.shape); curve && part == ControlPart::jump)
        return color ? to_values(curve->color_jump) : to_values(curve->height_jump);
    if (const auto* region = std::get_if<PoissonRegion>(&primitive.shape); region && part == ControlPart::region)
        return color ? to_values(region->color) : to_values(region->height);
    return {};
}

}  // namespace

void add_scaled(ControlSum& sum, const ControlSum& other, double scale) {
    for (const ControlTerm& term : other) {
        const auto at = std::lower_bound(sum.begin(), sum.end(), term,
                                         [](const ControlTerm& a, const ControlTerm& b) { return a.place() < b.place(); });
        if (at != sum.end() && at->place() == term.place())
            at->weight += scale * term.weight;
        else
            sum.insert(at, {term.control, term.stop, term.t, scale * term.weight});
    }
}

StopWeights stops_of(const ControlTerm& term, const Control& control) {
    if (term.stop != none)
        return {{static_cast<std::size_t>(term.stop), 0}, {term.weight, 0}};
    StopWeights stops = stop_weights(control.t, term.t, control.closed);
    for (double& weight : stops.weight) weight *= term.weight;
    return stops;
}

Eigen::RowVectorXd value_of(const ControlSum& sum, std::span<const Control> controls, int channels) {
    Eigen::RowVectorXd value = Eigen::RowVectorXd::Zero(channels);
    for (const ControlTerm& term : sum) {
        const Control& control = controls[term.control];
        const auto [stop, weight] = stops_of(term, control);
        for (int i = 0; i < 2; ++i)
            if (weight[i] != 0)
                value += weight[i] * control.value.row(static_cast<Eigen::Index>(stop[i]));
    }
    return value;
}

std::vector<Control> controls_of(const Scene& scene, const Domain& domain) {
    std::unordered_map<std::string, const Primitive*> primitive_at;
    for (const Layer& layer : scene.layers)
        for (const Primitive& primitive : layer.primitives)
            if (primitive.enabled)
                primitive_at.emplace(primitive.pointer, &primitive);
    std::vector<Control> controls = domain.controls;
    for (Control& control : controls) {
        const auto at = primitive_at.find(control.pointer);
        Values now =
            at == primitive_at.end() ? Values{} : values_in(*at->second, control.part, control.quantity, scene.color_space);
        control.t = std::move(now.t);
        control.value = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(now.value.size()), domain.channels);
        for (std::size_t k = 0; k < now.value.size(); ++k) {
            const Eigen::Index own = now.value[k].size();
            const Eigen::Index first = control.quantity == Quantity::color ? 0 : domain.channels - own;
            control.value.row(static_cast<Eigen::Index>(k)).segment(first, own) = now.value[k];
        }
    }
    return controls;
}

void apply_controls(Domain& domain) {
    for (const auto& [vertex, sum] : domain.held)
        domain.dirichlet_value.row(vertex) = value_of(sum, domain.controls, domain.channels);
    for (std::size_t c = 0; c < domain.couplings.size(); ++c)
        domain.couplings[c].jump = value_of(domain.jumps[c], domain.controls, domain.channels);
    for (std::size_t s = 0; s < domain.sources.size(); ++s)
        domain.sources[s].value = value_of(domain.source_values[s], domain.controls, domain.channels);
}

}  // namespace pvg
