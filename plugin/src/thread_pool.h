#pragma once

namespace osteon::plugin {

/// Keeps Embree's thread pool (oneTBB) in the process when this library is unloaded.
///
/// Embree starts a thread of that pool for a large mesh, such as an exported surface's, even where it is
/// asked for none. The thread idles on; unmapped with this library, its code would be gone when it wakes. Any
/// thread; does nothing where the pool is another one, or is in the process already for good.
void KeepThreadPoolMapped();

}  // namespace osteon::plugin
