// What the command says while it works: messages and a progress line on stderr; results alone go to stdout.
#pragma once

#include <string>
#include <string_view>

#include "pvg/status.h"

namespace pvg::app {

enum class Loudness { quiet, normal, verbose };

class Console {
public:
    explicit Console(Loudness loudness);
    ~Console();
    Console(const Console&) = delete;
    Console& operator=(const Console&) = delete;

    void note(std::string_view text);         ///< with -v only
    void say(std::string_view text);          ///< unless -q
    void warn(const Warnings& warnings);      ///< "warning: ..." each, unless -q
    static void fail(std::string_view text);  ///< always

    /// A stage begins. On a terminal, after the first second, one line shows what is going on; in a pipe nothing.
    void stage(int number, int count, std::string_view name);
    /// The part of the stage that is done, 0 to 1, shown with it.
    void progress(double part);
    void stages_done();

private:
    void show_stage(double part);
    void clear_line();
    Loudness loudness_;
    bool terminal_;
    bool line_shown_ = false;
    double started_ = 0, shown_ = 0;
    int stage_ = 0, stages_ = 0;
    std::string stage_name_;
};

}  // namespace pvg::app
