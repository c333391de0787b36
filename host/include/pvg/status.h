// Errors as the library reports them. Inside the library an Error is thrown; every public entry point
// catches it and hands it back as a Result, so that an embedder never sees an exception.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pvg {

/// What went wrong, numbered as the exit code of the command-line tool.
enum class ErrorKind : int {
    check_failed = 1,  ///< a check or some items of a batch did not pass
    usage = 2,         ///< wrong arguments
    bad_input = 3,     ///< a file, scene or mesh; the message says where and what would be right
    device = 4,        ///< no usable device, or the device failed
    output = 5,        ///< the output could not be written; what was there before is untouched
};

/// An error with its kind. The message names the file, the place in it, what is wrong and what would be right.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const { return kind_; }

private:
    ErrorKind kind_;
};

/// Either a value or an Error.
template <typename T>
class [[nodiscard]] Result {
public:
    Result(T value) : content_(std::move(value)) {}
    Result(Error error) : content_(std::move(error)) {}

    bool ok() const { return std::holds_alternative<T>(content_); }
    explicit operator bool() const { return ok(); }
    /// The value; only when ok().
    T& value() { return std::get<T>(content_); }
    const T& value() const { return std::get<T>(content_); }
    /// The error; only when not ok().
    const Error& error() const { return std::get<Error>(content_); }

private:
    std::variant<T, Error> content_;
};

/// Things a user should know that did not stop the work, one sentence each, in the order they were found.
using Warnings = std::vector<std::string>;

}  // namespace pvg
