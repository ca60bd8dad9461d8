#include "base/no_alloc_scope.h"

#include <dlfcn.h>
#include <pthread.h>

#include <cstddef>
#include <new>

// Replaces glibc's heap functions and pthread_mutex_lock by functions that count the call and then call the
// original. Not compiled under a sanitizer, which has its own heap functions.
#if defined(OSTEON_SANITIZED)
#define OSTEON_COUNTS_HEAP 0
#else
#define OSTEON_COUNTS_HEAP 1
#endif

// NOLINTBEGIN(bugprone-reserved-identifier): glibc's own names of the wrapped functions
extern "C" {
void* __libc_memalign(std::size_t, std::size_t);
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void __libc_free(void*);
}
// NOLINTEND(bugprone-reserved-identifier)

namespace {
thread_local bool t_armed = false;  // a NoAllocScope exists on this thread
thread_local int t_heap_calls = 0;
thread_local int t_locks = 0;
[[maybe_unused]] void CountHeapCall() {
  if (t_armed) ++t_heap_calls;
}
}  // namespace

#if OSTEON_COUNTS_HEAP
extern "C" {
int posix_memalign(void** out, std::size_t align, std::size_t n) {
  CountHeapCall();
  *out = __libc_memalign(align, n);
  return *out || n == 0 ? 0 : 12;  // ENOMEM
}
void* aligned_alloc(std::size_t align, std::size_t n) {
  CountHeapCall();
  return __libc_memalign(align, n);
}
void* memalign(std::size_t align, std::size_t n) {
  CountHeapCall();
  return __libc_memalign(align, n);
}
void* malloc(std::size_t n) {
  CountHeapCall();
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t s) {
  CountHeapCall();
  return __libc_calloc(n, s);
}
void* realloc(void* p, std::size_t n) {
  CountHeapCall();
  return __libc_realloc(p, n);
}
void free(void* p) {
  if (p) CountHeapCall();
  __libc_free(p);
}
int pthread_mutex_lock(pthread_mutex_t* mutex) {
  using Lock = int (*)(pthread_mutex_t*);
  static const Lock real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  if (t_armed) ++t_locks;
  return real(mutex);
}
}
#endif

namespace osteon::rt {

NoAllocScope::NoAllocScope() {
  t_heap_calls = 0;
  t_locks = 0;
  t_armed = true;
}
NoAllocScope::~NoAllocScope() { t_armed = false; }
bool NoAllocScope::Counts() {
  NoAllocScope scope;
  ::operator delete(::operator new(8));
  return scope.heap_calls() > 0;
}
int NoAllocScope::heap_calls() const { return t_heap_calls; }
int NoAllocScope::locks() const { return t_locks; }

}  // namespace osteon::rt
