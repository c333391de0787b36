// Sources that stay where they are: a patch's Laplacian is changed as little as possible so that nothing flows out of
// the patch, and the field outside is what it would be without the patch.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "curves/patch_poisson.h"

namespace pvg {

/// The patch's own problem (u = 0 on its border, load: what acts in it) sends the flux sigma through the border vertices; if that
/// were 0, 0 outside would solve the whole problem. Returns the change d of the Laplacian, one value a face of the part and 0
/// where not adjustable, that minimises
///   integral of d^2 + sigma' L^-1 sigma / (share * width)^2,
/// L the patch's map from border values to fluxes: the second term is the energy of what leaks, and weighs it so that variations
/// along the border much finer than `width` (of the ring or strip), which die out beside it and which the mesh cannot resolve,
/// are left alone. The minimiser is a harmonic function cut off outside the adjustable faces; its border values solve (M + (share
/// * width)^2 L) mu = -sigma_0, M_ij the integral of H_i H_j over the adjustable faces, H_i harmonic and 1 at border vertex i
/// (conjugate gradients; M and L are never formed). The share starts at 0.05 and is halved until the force left on a border
/// vertex is no more than `most` in the root mean square, or until it is a sixteenth of that.
std::vector<double> level_outside(const PatchPoisson& own, double width, std::span<const char> adjustable,
                                  const Eigen::VectorXd& load, double most = std::numeric_limits<double>::infinity());

}  // namespace pvg
