// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/status.hpp"

namespace bpa::io {

/// When what was written is on the disk, whatever happens to the machine.
enum class Sync {
  now,    ///< When the call returns.
  later,  ///< Some time; sync_folder() waits for it.
};

/// A file that is written under another name beside and gets its own when it is complete. A process
/// that dies, or a machine that loses its power, leaves what was at the path before. Functions fail
/// with unavailable, which names the path and the system's reason; after that all do.
class NewFile {
 public:
  /// Makes or empties `beside`, which is in the folder of `path`.
  static Result<NewFile> create(const std::string& path, const std::string& beside);
  NewFile(NewFile&& other) noexcept;
  NewFile& operator=(NewFile&&) = delete;
  /// Closes it. What was not committed stays beside.
  ~NewFile();

  Status append(std::string_view bytes);
  /// Writes over bytes that are there already.
  Status overwrite(std::uint64_t position, std::string_view bytes);
  std::uint64_t size() const { return size_; }

  /// Gives the file its name, in place of one that has it. The last call.
  Status commit(Sync sync = Sync::now);
  /// Removes what was written. The last call.
  void discard();

 private:
  NewFile(std::string path, std::string beside, int descriptor)
      : path_(std::move(path)), beside_(std::move(beside)), descriptor_(descriptor) {}
  Status write_at(std::uint64_t position, std::string_view bytes);
  Status fail();
  void close();

  std::string path_, beside_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  Status failed_;
};

/// Waits until all that was written to the folder's file system is on the disk. Fails with
/// unavailable.
Status sync_folder(const std::string& path);

/// Puts a folder that is complete in place of another: at any time `path` is one of the two, where
/// the file system can exchange names (NFS cannot). What it replaces is removed. Fails with
/// unavailable.
Status replace_folder(const std::string& fresh, const std::string& path);

}  // namespace bpa::io
