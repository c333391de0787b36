#include "gltf/files.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace pvg {
namespace {

/// A file descriptor that closes itself.
struct Descriptor {
    int number;
    explicit Descriptor(int n) : number(n) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number >= 0)
            ::close(number);
    }
};

std::string reason() { return std::strerror(errno); }

}  // namespace

std::vector<unsigned char> read_file(const std::filesystem::path& file) {
    const auto fail = [&] [[noreturn]] (const std::string& what) {
        throw Error(ErrorKind::bad_input, file.string() + ": " + what);
    };
    // Non-blocking, so that a pipe without a writer is refused and not waited for.
    const Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (in.number < 0)
        fail("cannot be read: " + reason());
    struct stat status {};
    if (::fstat(in.number, &status) != 0)
        fail("cannot be read: " + reason());
    if (!S_ISREG(status.st_mode))
        fail("is not a regular file");
    std::vector<unsigned char> bytes(static_cast<std::size_t>(status.st_size));
    std::size_t at = 0;
    while (at < bytes.size()) {
        const ssize_t count = ::read(in.number, bytes.data() + at, bytes.size() - at);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            fail("cannot be read: " + reason());
        if (count == 0)
            break;
        at += static_cast<std::size_t>(count);
    }
    bytes.resize(at);
    return bytes;
}

void write_file_atomically(const std::filesystem::path& file, std::span<const unsigned char> bytes) {
    static std::atomic<unsigned> serial{0};
    const auto fail = [&] [[noreturn]] (const std::string& what) {
        throw Error(ErrorKind::output, file.string() + ": cannot be written: " + what);
    };
    std::error_code ignored;
    std::filesystem::path target = file;
    if (std::filesystem::is_symlink(file, ignored))
        target = std::filesystem::weakly_canonical(file, ignored);
    if (target.filename().empty())
        fail("expected the name of a file");
    struct stat before {};
    const bool exists = ::stat(target.c_str(), &before) == 0;
    if (exists && !S_ISREG(before.st_mode))
        fail("it is not a regular file");
    if (exists && ::access(target.c_str(), W_OK) != 0)
        fail(reason());

    std::filesystem::path temporary;
    int number = -1;
    for (int attempt = 0; attempt < 100 && number < 0; ++attempt) {
        temporary = target;
        temporary += "." + std::to_string(::getpid()) + "-" + std::to_string(serial++) + ".pvg-tmp";
        number = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (number < 0 && errno != EEXIST)
            break;
    }
    if (number < 0)
        fail(reason());
    const auto abandon = [&] [[noreturn]] () {
        const std::string why = reason();
        ::unlink(temporary.c_str());
        fail(why);
    };
    {
        Descriptor out(number);
        std::size_t at = 0;
        while (at < bytes.size()) {
            const ssize_t count = ::write(out.number, bytes.data() + at, bytes.size() - at);
            if (count < 0 && errno == EINTR)
                continue;
            if (count < 0)
                abandon();
            at += static_cast<std::size_t>(count);
        }
        if (exists && ::fchmod(out.number, before.st_mode & 07777) != 0)
            abandon();
        if (::fsync(out.number) != 0)
            abandon();
        const int descriptor = out.number;
        out.number = -1;
        if (::close(descriptor) != 0)
            abandon();
    }
    if (::rename(temporary.c_str(), target.c_str()) != 0)
        abandon();
    // The name itself reaches the disk with its folder; a file system that cannot sync folders has done what it can.
    const std::filesystem::path folder = target.parent_path().empty() ? std::filesystem::path(".") : target.parent_path();
    const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (directory.number >= 0)
        (void)::fsync(directory.number);
}

}  // namespace pvg
