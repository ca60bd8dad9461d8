// Includes the header for hosts as another project does: installed, in C++17, without exceptions.
#include <osteon_host.h>

static_assert(__cplusplus < 202002L, "osteon_host.h is C++17");
static_assert(osteon::host::kGodot.TurnsTrianglesOver());
