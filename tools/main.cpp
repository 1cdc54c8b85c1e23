// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/allocations.hpp"

namespace bpa::cli {
int run_bpa(int argc, char** argv, std::uint64_t (*allocations)());
}

int main(int argc, char** argv) {
  return bpa::cli::run_bpa(argc, argv, bpa::cli::count_allocations);
}
