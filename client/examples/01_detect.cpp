// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Ask a running bpa-server what its camera sees now.

#include <iostream>

#include <bpa/client.hpp>

int main() {
  auto client = bpa::Client::connect();
  if (!client.ok()) return std::cerr << client.status().message << '\n', 1;
  const auto found = client->detect();
  if (!found.ok()) return std::cerr << found.status().message << '\n', 1;
  for (const bpa::Detection& d : found->best()) {
    const auto& p = d.camera_from_object.position;
    std::cout << d.model << ": " << 100 * d.probability << " % at " << p[0] << ' ' << p[1] << ' '
              << p[2] << " m\n";
  }
}

// Expected output, one line for each object:
//   mug: 97.1 % at 0.0912 -0.0311 0.8123 m
