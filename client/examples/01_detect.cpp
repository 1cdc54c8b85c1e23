// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Ask a running bpa-server what its camera sees now.

#include <iostream>
#include <string>

#include <bpa/client.hpp>

int fail(const std::string& message) {
  std::cerr << message << '\n';
  return 1;
}

int main() {
  auto client = bpa::Client::connect();
  if (!client.ok()) return fail(client.status().message);
  const auto found = client->detect();
  if (!found.ok()) return fail(found.status().message);
  for (const bpa::Detection& d : found->best()) {
    const auto& p = d.camera_from_object.position;
    std::cout << d.model << ": " << 100 * d.probability << " % at " << p[0] << ' ' << p[1] << ' '
              << p[2] << " m\n";
  }
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   stub: 87.5 % at 0 0 0.8 m
