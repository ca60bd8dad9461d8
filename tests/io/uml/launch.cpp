// launch COMMAND …: runs the command without the processor's extended register sets as seen by ptrace
// (NT_X86_XSTATE), so that user-mode Linux uses the basic ones. User-mode Linux has a buffer of fixed size
// for the extended sets. On processors with larger sets (AMX) user-mode Linux would end with "ptrace set fp
// regs failed".

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>

int main(int argc, char** argv) {
  constexpr unsigned kXstate = 0x202;  // elf.h's NT_X86_XSTATE
  if (argc < 2) {
    std::fputs("usage: launch COMMAND …\n", stderr);
    return 2;
  }
  // Makes the instruction that loads the word at this offset of seccomp_data.
  const auto load = [](std::size_t offset) {
    return sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<unsigned>(offset));
  };
  // Makes the instruction that skips `skip` instructions unless the loaded word equals `value`.
  const auto skip_unless = [](unsigned value, std::uint8_t skip) {
    return sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, skip);
  };
  // ptrace(PTRACE_GETREGSET, …, NT_X86_XSTATE) fails with EINVAL; all other calls are allowed.
  std::array<sock_filter, 10> filter{load(offsetof(seccomp_data, arch)),
                                     skip_unless(AUDIT_ARCH_X86_64, 7),
                                     load(offsetof(seccomp_data, nr)),
                                     skip_unless(SYS_ptrace, 5),
                                     load(offsetof(seccomp_data, args[0])),
                                     skip_unless(PTRACE_GETREGSET, 3),
                                     load(offsetof(seccomp_data, args[2])),
                                     skip_unless(kXstate, 1),
                                     BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL),
                                     BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const sock_fprog program{.len = filter.size(), .filter = filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
    std::perror("launch: seccomp");
    return 1;
  }
  execvp(argv[1], argv + 1);
  std::perror(argv[1]);
  return 1;
}
