// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What does the server know, and how is it doing?

#include <iostream>

#include <bpa/client.hpp>

int main() {
  auto client = bpa::Client::connect();
  if (!client.ok()) return std::cerr << client.status().message << '\n', 1;
  const auto models = client->models();
  const auto status = client->status();
  if (!models.ok()) return std::cerr << models.status().message << '\n', 1;
  if (!status.ok()) return std::cerr << status.status().message << '\n', 1;
  for (const bpa::KnownModel& model : *models) {
    std::cout << model.name << ", " << 1000 * model.diameter << " mm across\n";
  }
  std::cout << status->frames_processed << " frames searched, " << status->frames_dropped
            << " dropped\n";
}

// Expected output:
//   mug, 143 mm across
//   120 frames searched, 3 dropped
