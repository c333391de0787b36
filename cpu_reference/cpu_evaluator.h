// The reference evaluator: the same loops in the same order and the same single precision as the shaders in kernels/,
// compiled without contraction, so that a conforming device agrees bit for bit.
#pragma once

#include "pvg/program.h"

namespace pvg {

/// Requires validate(program). threads: 0 for all cores; the result does not depend on it.
Evaluation evaluate_on_cpu(const Program& program, int threads = 0);

}  // namespace pvg
