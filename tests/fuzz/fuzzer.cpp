// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// libFuzzer's program: BPA_FUZZ_TARGET names the target; all arguments are libFuzzer's.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/fuzz/target.hpp"

namespace {

bpa::fuzz::Target chosen;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("BPA_FUZZ_TARGET");
  for (const bpa::fuzz::Target& target : bpa::fuzz::targets()) {
    if (name != nullptr && target.name == std::string(name)) chosen = target;
  }
  if (chosen.run != nullptr) return 0;
  std::fprintf(stderr, "BPA_FUZZ_TARGET names no target\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen.run({reinterpret_cast<const char*>(data), size});
  return 0;
}
