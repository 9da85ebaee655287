// How the program ends where something goes wrong, wherever that is: one line a problem on stderr, and a documented exit status.
//
// Errors arrive in main() as exceptions. What cannot (thrown in a thread of a library, or before main()) ends in the terminate
// handler, which this file installs before anything else of the process runs.
#pragma once

#include <string_view>

namespace kelpie {

/// What the program is about to do ("rendering frame 12"), for the line that says where memory ran out.
void set_activity(std::string_view) noexcept;

/// In a catch block: says what was caught, and returns the exit status. Whatever fails after memory ran out (a decoder that
/// gives no reason, say) has failed for that reason.
int report_failure() noexcept;

} // namespace kelpie
