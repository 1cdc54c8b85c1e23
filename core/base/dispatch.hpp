// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before a function: compiles it for x86-64 processors with AVX2 too, and the loader chooses. For
/// straight-line loops over arrays. Results are the same to the bit: -ffp-contract=off. Every ARM64
/// has NEON. The loader chooses before ThreadSanitizer has begun, so with it there is no choice.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define BPA_DISPATCH __attribute__((target_clones("avx2", "default")))
#else
#define BPA_DISPATCH
#endif
