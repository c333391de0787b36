// pvg bench: a program of its own does the work (tests/bench), because rivals that it links are under the GPL.
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "app/verbs.h"
#include "pvg/status.h"

namespace pvg::app {

int bench(const std::vector<std::string>& arguments) {
    std::error_code failed;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
    const std::filesystem::path program = self.parent_path() / "pvg-bench";
    if (failed || !std::filesystem::exists(program))
        throw Error(ErrorKind::usage, "bench: " + program.string() +
                                          " is not there; it is built with the tests (-DPVG_BUILD_TESTS=ON, needs "
                                          "libsuitesparse-dev and libcgal-dev)");
    std::vector<char*> argv{const_cast<char*>("pvg bench")};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    // OpenBLAS does not know every virtual processor's name and then takes one without AVX2; the rival shall have its best.
    if (__builtin_cpu_supports("avx2"))
        setenv("OPENBLAS_CORETYPE", "Haswell", 0);
    execv(program.c_str(), argv.data());
    throw Error(ErrorKind::usage, "bench: " + program.string() + " cannot be run: " + std::strerror(errno));
}

}  // namespace pvg::app
