#pragma once

/// Compiles a function once for each x86-64 level worth having and picks one when the program is loaded. All clones
/// give the same bits: -ffp-contract=off forbids fused multiply-add, and every sum has its own fixed order.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(COMPUEYE_NO_MULTIVERSION)
#define COMPUEYE_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
// A function of its own here too: what is inlined adds to the stack of every caller on the way down.
#define COMPUEYE_MULTIVERSION __attribute__((noinline))
#endif

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(COMPUEYE_NO_MULTIVERSION)
/// A function that is written with vectors of 64 bytes, which no other level than this has registers for: to be called
/// only where has_widest_vectors().
#define COMPUEYE_WIDEST __attribute__((target("avx512f"), noinline))
namespace compueye::recon::core {
[[nodiscard]] inline bool has_widest_vectors() noexcept {
  return __builtin_cpu_supports("avx512f") != 0;
}
}  // namespace compueye::recon::core
#endif

#if defined(COMPUEYE_NO_MULTIVERSION)
// Sanitizers put several checks beside every access: copies of those in every caller take the compiler minutes.
#define COMPUEYE_INLINE inline
#else
#define COMPUEYE_INLINE inline __attribute__((always_inline))
#endif

/// A part of a multiversion function: inlined into each clone; a function of its own, with a frame of its own, where
/// there are none and stack is dear.
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
#define COMPUEYE_STAGE __attribute__((noinline))
#else
#define COMPUEYE_STAGE COMPUEYE_INLINE
#endif

// What few registers and little stack ask for; it changes no bit.
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
#define COMPUEYE_CORTEX_M
#if !defined(__ARM_FEATURE_MVE)
#define COMPUEYE_PLAIN_LANES  // no vectors: Cortex-M4 and M7
#endif
#endif
