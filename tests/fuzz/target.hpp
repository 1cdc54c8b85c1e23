// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Fuzz targets: one function for each decoder of foreign bytes. fuzzer.cpp lets libFuzzer call
// them, corpus.cpp calls them on files.

namespace bpa::fuzz {

/// A decoder, and the bounds that hold for any input of up to `max_bytes`.
struct Target {
  const char* name = "";
  const char* sources = "";  ///< The files that decode, separated by spaces: their lines count.
  /// Returns whatever the bytes are. Aborts where what was decoded breaks a promise.
  void (*run)(std::string_view bytes) = nullptr;
  std::vector<std::string> (*seeds)() = nullptr;  ///< Legal inputs, to begin with.
  int max_bytes = 8192;
  int malloc_mb = 64;  ///< The largest single allocation.
};

/// The targets of each file.
std::vector<Target> image_targets();
std::vector<Target> cloud_targets();
std::vector<Target> mesh_targets();
std::vector<Target> model_targets();
std::vector<Target> data_set_targets();
std::vector<Target> settings_targets();
std::vector<Target> message_targets();
std::vector<Target> frame_targets();
std::vector<Target> recording_targets();
std::vector<Target> web_targets();

/// All of them.
std::vector<Target> targets();

/// Aborts with the promise when it does not hold.
void require(bool holds, const char* promise);

/// The path of a file with these bytes, in a folder that this process alone has. The next file of
/// the name replaces it.
std::string file_of(std::string_view bytes, const std::string& name);

}  // namespace bpa::fuzz
