#pragma once

namespace osteon::plugin {

/// Keeps Embree's thread pool (oneTBB) in the process when this library is unloaded.
///
/// For a large mesh, such as an exported surface, Embree starts a thread of this pool even if it was asked
/// for no threads. The thread then sleeps. If its code were unmapped with this library, the process would
/// crash when the thread wakes. May be called by any thread. Does nothing if Embree uses another thread pool,
/// or if the pool stays in the process anyway.
void KeepThreadPoolMapped();

}  // namespace osteon::plugin
