// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
namespace bpa::cli {
int run_bpa(int argc, char** argv);
}

int main(int argc, char** argv) { return bpa::cli::run_bpa(argc, argv); }
