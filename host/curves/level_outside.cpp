#include "curves/level_outside.h"

namespace pvg {

std::vector<double> level_outside(const PatchPoisson& own, double width, std::span<const char> adjustable,
                                  const Eigen::VectorXd& load) {
    // Measured on a disk, a square, an L and strokes, rings 0.5 to 5 edges wide: less leaves more leak, more lets the noise of
    // the triangles into f.
    constexpr double share = 0.05;
    const double weight = share * width * share * width;
    const auto flux_of = [&](const Eigen::VectorXd& all) { return own.flux(own.solve(all), all); };
    const auto cut_off = [&](const Eigen::VectorXd& harmonic) {
        std::vector<double> change = own.face_means(harmonic);
        for (std::size_t f = 0; f < change.size(); ++f)
            if (!adjustable[f])
                change[f] = 0;
        return change;
    };
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(own.vertex_count());
    constexpr int most_steps = 100;
    Eigen::VectorXd residual = -flux_of(load);
    Eigen::VectorXd direction = residual, heights = nothing;
    double square = residual.squaredNorm();
    const double enough = 1e-6 * square;
    for (int step = 0; step < most_steps && square > enough; ++step) {
        const Eigen::VectorXd harmonic = own.harmonic(direction);
        const Eigen::VectorXd image = flux_of(own.load_of(cut_off(harmonic))) + weight * own.flux(harmonic, nothing);
        const double curvature = direction.dot(image);
        if (!(curvature > 0))
            break;
        heights += square / curvature * direction;
        residual -= square / curvature * image;
        const double next = residual.squaredNorm();
        direction = residual + next / square * direction;
        square = next;
    }
    return cut_off(own.harmonic(heights));
}

}  // namespace pvg
