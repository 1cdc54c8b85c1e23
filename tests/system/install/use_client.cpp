// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include <bpa/client.hpp>

// Nobody serves this name, and the SDK says so in time.
int main() {
  bpa::ClientOptions options;
  options.server_namespace = "/nobody_serves_this";
  options.timeout = std::chrono::milliseconds(300);
  options.range_from_environment = false;
  options.range = bpa::DiscoveryRange::localhost;
  const auto client = bpa::Client::connect(options);
  std::cout << (client.ok() ? "connected" : client.status().message) << '\n';
  return client.ok() ? 1 : 0;
}
