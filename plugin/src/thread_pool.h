#pragma once

namespace osteon::plugin {

/// Keeps Embree's thread pool (oneTBB) in the process when this library is unloaded.
///
/// Embree starts a thread of that pool for a large mesh, such as an exported surface's, even where it is
/// asked for none. The thread stays, asleep. If its code were unmapped with this library, the process would
/// crash when the thread wakes. Any thread; does nothing if the pool is another one, or stays anyway.
void KeepThreadPoolMapped();

}  // namespace osteon::plugin
