// The one place through which messages and results leave the program.
#pragma once

#include <string_view>

namespace kelpie {

/// Where a standard stream is closed, opens in its place what fails when it is used: else the next file that is opened would
/// become that stream, and messages would be written into it. To be called before any file is opened.
void reserve_standard_streams() noexcept;

/// A message to stderr, in one piece. A message that cannot be written (a full disk, a reader that went away) is lost, and that is no
/// reason to stop: what the program makes is elsewhere.
void print_message(std::string_view) noexcept;

/// Ends the line of a message that was left open (a progress bar). Async-signal-safe.
void end_message_line() noexcept;

/// A result to stdout. Throws Error cannot_write where it cannot be written.
void print_result(std::string_view);

} // namespace kelpie
