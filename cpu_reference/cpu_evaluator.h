// The reference evaluator: the same loops in the same order and the same single precision as the shaders in kernels/,
// compiled without contraction, so that a conforming device agrees bit for bit.
#pragma once

#include "pvg/program.h"

namespace pvg {

/// Requires validate(program). threads: 0 for all cores; the result does not depend on it.
Evaluation evaluate_on_cpu(const Program& program, int threads = 0);
/// The same into `result`, whose memory is used again where it is large enough. wide: eight rows at a time where the processor
/// has AVX2; the bits do not depend on it.
void evaluate_on_cpu(const Program& program, Evaluation& result, int threads = 0, bool wide = true);

}  // namespace pvg
