#include "app/console.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace pvg::app {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void line(std::string_view prefix, std::string_view text) {
    std::fprintf(stderr, "%.*s%.*s\n", static_cast<int>(prefix.size()), prefix.data(), static_cast<int>(text.size()),
                 text.data());
}

}  // namespace

Console::Console(Loudness loudness) : loudness_(loudness), terminal_(isatty(STDERR_FILENO) == 1), started_(now()) {}
Console::~Console() { clear_line(); }

void Console::note(std::string_view text) {
    if (loudness_ != Loudness::verbose)
        return;
    clear_line();
    line("", text);
}

void Console::say(std::string_view text) {
    if (loudness_ == Loudness::quiet)
        return;
    clear_line();
    line("", text);
}

void Console::warn(const Warnings& warnings) {
    if (loudness_ == Loudness::quiet)
        return;
    clear_line();
    for (const std::string& warning : warnings) line("warning: ", warning);
}

void Console::fail(std::string_view text) { line("pvg: ", text); }

void Console::stage(int number, int count, std::string_view name) {
    stage_ = number;
    stages_ = count;
    stage_name_ = name;
    show_stage(0);
}

void Console::progress(double part) {
    constexpr double pause = 0.1;  // seconds between two pictures of one stage
    if (now() - shown_ >= pause)
        show_stage(part);
}

void Console::show_stage(double part) {
    if (loudness_ == Loudness::quiet || !terminal_ || now() - started_ < 1)
        return;
    constexpr int width = 30;
    const int filled = stages_ > 0 ? static_cast<int>(width * (stage_ + part) / stages_) : width;
    std::fprintf(stderr, "\r\033[K[");
    for (int i = 0; i < width; ++i) std::fputc(i < filled ? '#' : '.', stderr);
    std::fprintf(stderr, "] %d/%d %s", stage_ + 1, stages_, stage_name_.c_str());
    if (part > 0)
        std::fprintf(stderr, " %.0f %%", 100 * part);
    std::fflush(stderr);
    line_shown_ = true;
    shown_ = now();
}

void Console::stages_done() { clear_line(); }

void Console::clear_line() {
    if (!line_shown_)
        return;
    std::fprintf(stderr, "\r\033[K");
    std::fflush(stderr);
    line_shown_ = false;
}

}  // namespace pvg::app
