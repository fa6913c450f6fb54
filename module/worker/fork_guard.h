// What a fork of a process with workers may still do: it has the locks that their threads held, and not the threads.
#pragma once

namespace welkin::detail {

/// Before threads are made. Throws `Error` (stopped) in a process that was forked while one of our calls computed or a
/// worker had threads, and where oneTBB does not answer within some seconds, as a thread of the parent's was inside it;
/// std::system_error if the thread that asks it cannot be made. Costs nothing in a process that is no fork, and in a
/// fork the first time only.
void require_no_lost_locks();

}  // namespace welkin::detail
