// The commands of pvg: options as parsed, one function each. They throw Error; main turns it into an exit code.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/console.h"

namespace pvg::app {

struct DecorateOptions {
    std::filesystem::path scene;
    std::filesystem::path out;
    std::string device = "auto";
    std::vector<std::string> assignments;  ///< --set
    std::string basis;                     ///< instead of the scene's; empty: the scene's
    std::optional<std::filesystem::path> report;
    bool fields = false;
    bool no_displace = false;
    int threads = 0;
};
int decorate(const DecorateOptions& options, Console& console);

struct CheckOptions {
    std::filesystem::path scene;
    std::string device = "auto";
    std::vector<std::string> assignments;
    std::string basis;  ///< instead of the scene's; empty: the scene's
    bool all_bases = false;
    std::string tolerance = "0.1,1,5";
    bool json = false;
    int threads = 0;
};
int check(const CheckOptions& options, Console& console);

struct MakeOptions {
    std::string shape;
    std::filesystem::path out;
    int vertices = 10000;
};
int make(const MakeOptions& options, Console& console);

struct InfoOptions {
    std::filesystem::path file;
    bool json = false;
};
int info(const InfoOptions& options, Console& console);

struct DevicesOptions {
    bool json = false;
};
int devices(const DevicesOptions& options, Console& console);

/// Becomes the program pvg-bench, which stands beside this one. arguments: what follows the verb. Throws Error(usage) where it is
/// not there.
int bench(const std::vector<std::string>& arguments);

}  // namespace pvg::app
