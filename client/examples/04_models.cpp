// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What does the server know, and how is it doing?

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
  const auto models = client->models();
  const auto status = client->status();
  if (!models.ok()) return fail(models.status().message);
  if (!status.ok()) return fail(status.status().message);
  for (const bpa::KnownModel& model : *models) {
    std::cout << model.name << ", " << 1000 * model.diameter << " mm across\n";
  }
  std::cout << status->frames_processed << " frames searched, " << status->frames_dropped
            << " dropped\n";
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   stub, 200 mm across
//   0 frames searched, 0 dropped
