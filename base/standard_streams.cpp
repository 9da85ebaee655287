#include "base/standard_streams.h"

#include <atomic>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "base/error.h"
#include "base/file_bytes.h"
#include "base/file_descriptor.h"

namespace kelpie {

namespace {
std::atomic<bool> g_is_in_line{false};
}

void reserve_standard_streams() noexcept {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    // Open for the other direction. It gets the number: all lower ones are taken.
    const int number = open("/dev/full", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (number >= 0 && number != stream) close(number);
  }
}

void print_message(std::string_view text) noexcept {
  write_fully(STDERR_FILENO, as_bytes(text));
  if (!text.empty()) g_is_in_line = text.back() != '\n';
}

void end_message_line() noexcept {
  if (g_is_in_line.exchange(false)) write_fully(STDERR_FILENO, as_bytes("\n"));
}

void print_result(std::string_view text) {
  if (const int why = write_fully(STDOUT_FILENO, as_bytes(text)))
    throw Error(ExitStatus::cannot_write, std::string("cannot write to stdout: ") + std::strerror(why));
}

} // namespace kelpie
