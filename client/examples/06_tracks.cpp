// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Follows the objects before the server's camera: each keeps its id and its name. The first object
// that is confirmed gets a name, and the program ends when a track has it.

#include <cstdint>
#include <future>
#include <iostream>
#include <map>
#include <string>

#include <bpa/client.hpp>

int fail(const std::string& message) {
  std::cerr << message << '\n';
  return 1;
}

int main() {
  std::map<std::uint64_t, std::string> names;  // of confirmed tracks, by id
  std::promise<std::uint64_t> confirmed;
  std::promise<void> renamed;
  auto client = bpa::Client::connect();  // calls back until it is destroyed: after the above
  if (!client.ok()) return fail(client.status().message);

  const auto subscribed = client->tracks([&](const bpa::TrackSet& set) {
    for (const bpa::TrackedObject& object : set.tracks) {
      if (object.state != bpa::TrackedState::confirmed || names[object.id] == object.name) continue;
      std::cout << object.id << ' ' << object.name << ' ' << object.model << std::endl;
      names[object.id] = object.name;
      if (names.size() == 1 && object.name != "mine") confirmed.set_value(object.id);
      if (object.name == "mine") renamed.set_value();
    }
  });
  if (!subscribed.ok()) return fail(subscribed.message);

  const std::string first = std::to_string(confirmed.get_future().get());
  const auto status = client->rename_track(first, "mine");  // by its id
  if (!status.ok()) return fail(status.message);
  renamed.get_future().wait();
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   1 stub_1 stub
//   1 mine stub
