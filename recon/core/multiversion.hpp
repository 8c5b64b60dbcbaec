#pragma once

/// Compiles a function once for each x86-64 level worth having and picks one when the program is loaded. All clones
/// give the same bits: -ffp-contract=off forbids fused multiply-add, and every sum has its own fixed order.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(COMPUEYE_NO_MULTIVERSION)
#define COMPUEYE_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define COMPUEYE_MULTIVERSION
#endif

#define COMPUEYE_INLINE inline __attribute__((always_inline))
