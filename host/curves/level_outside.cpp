#include "curves/level_outside.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pvg {

std::vector<double> level_outside(const PatchPoisson& own, double width, std::span<const char> adjustable,
                                  const Eigen::VectorXd& load, double most) {
    // Measured on a disk, a square, an L and strokes, rings 0.5 to 5 edges wide: less leaves more leak, more lets the noise of
    // the triangles into f.
    constexpr double first_share = 0.05, last_share = first_share / 16;
    const auto flux_of = [&](const Eigen::VectorXd& all) { return own.flux(own.solve(all), all); };
    const auto cut_off = [&](const Eigen::VectorXd& harmonic) {
        std::vector<double> change = own.face_means(harmonic);
        for (std::size_t f = 0; f < change.size(); ++f)
            if (!adjustable[f])
                change[f] = 0;
        return change;
    };
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(own.vertex_count()), target = -flux_of(load);
    const double enough = 1e-6 * target.squaredNorm();
    Eigen::VectorXd heights = nothing;  // mu
    for (double share = first_share;; share /= 2) {
        const double weight = share * width * share * width;
        // M mu and L mu for any mu.
        const auto images = [&](const Eigen::VectorXd& mu) {
            const Eigen::VectorXd harmonic = own.harmonic(mu);
            return std::pair(flux_of(own.load_of(cut_off(harmonic))), Eigen::VectorXd(own.flux(harmonic, nothing)));
        };
        const auto [mass, energy] = images(heights);
        Eigen::VectorXd residual = target - mass - weight * energy, direction = residual;
        double square = residual.squaredNorm();
        constexpr int most_steps = 100;
        for (int step = 0; step < most_steps && square > enough; ++step) {
            const auto [direction_mass, direction_energy] = images(direction);
            const Eigen::VectorXd image = direction_mass + weight * direction_energy;
            const double curvature = direction.dot(image);
            if (!(curvature > 0))
                break;
            heights += square / curvature * direction;
            residual -= square / curvature * image;
            const double next = residual.squaredNorm();
            direction = residual + next / square * direction;
            square = next;
        }
        const std::vector<double> change = cut_off(own.harmonic(heights));
        const double left = flux_of(load + own.load_of(change)).norm() / std::sqrt(std::max(1.0, double(own.border_count())));
        if (share <= last_share || left <= most)
            return change;
    }
}

}  // namespace pvg
