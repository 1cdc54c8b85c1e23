// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/new_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/concat.hpp"

namespace bpa::io {
namespace {

namespace files = std::filesystem;

constexpr mode_t kNewFileMode = 0666;  // less the umask

Status cannot_be_written(const std::string& path) {
  return unavailable(path, " cannot be written: ", std::strerror(errno));
}

/// `sync` is fsync, for the names in a folder, or syncfs, for all of its file system.
Status sync_by(int (*sync)(int), const std::string& folder) {
  const int descriptor =
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && sync(descriptor) == 0;
  const Status status = synced ? Status() : cannot_be_written(folder);
  if (descriptor >= 0) ::close(descriptor);
  return status;
}

/// Waits until the names in a folder are on the disk.
Status sync_names(const std::string& folder) { return sync_by(::fsync, folder); }

}  // namespace

Result<NewFile> NewFile::create(const std::string& path, const std::string& beside) {
  const int descriptor =
      ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kNewFileMode);
  if (descriptor < 0) return cannot_be_written(path);
  return NewFile(path, beside, descriptor);
}

NewFile::NewFile(NewFile&& other) noexcept
    : path_(std::move(other.path_)),
      beside_(std::move(other.beside_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_),
      failed_(std::move(other.failed_)) {}

NewFile::~NewFile() { close(); }

void NewFile::close() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

Status NewFile::fail() { return failed_ = cannot_be_written(path_); }

Status NewFile::write_at(std::uint64_t position, std::string_view bytes) {
  while (failed_.ok() && !bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(position));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return fail();
    bytes.remove_prefix(static_cast<std::size_t>(written));
    position += static_cast<std::uint64_t>(written);
  }
  return failed_;
}

Status NewFile::append(std::string_view bytes) {
  const Status status = write_at(size_, bytes);
  if (status.ok()) size_ += bytes.size();
  return status;
}

Status NewFile::overwrite(std::uint64_t position, std::string_view bytes) {
  return write_at(position, bytes);
}

Status NewFile::commit(Sync sync) {
  if (!failed_.ok()) return failed_;
  if (sync == Sync::now && ::fsync(descriptor_) != 0) return fail();
  if (::close(std::exchange(descriptor_, -1)) != 0) return fail();
  if (std::rename(beside_.c_str(), path_.c_str()) != 0) return fail();
  return sync == Sync::now ? sync_names(files::path(path_).parent_path().string()) : Status();
}

void NewFile::discard() {
  close();
  ::unlink(beside_.c_str());
}

Status sync_folder(const std::string& path) { return sync_by(::syncfs, path); }

Status replace_folder(const std::string& fresh, const std::string& path) {
  std::error_code error;
  const bool replaces = files::exists(path, error);
  if (Status status = sync_names(fresh); !status.ok()) return status;
  std::string old = fresh;  // where the old one is after they were exchanged
  const unsigned flags = replaces ? RENAME_EXCHANGE : 0;
  int failed = ::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, path.c_str(), flags);
  if (failed != 0 && replaces && errno == EINVAL) {  // a file system that cannot, such as NFS
    old += ".old";
    files::remove_all(old, error);
    failed = std::rename(path.c_str(), old.c_str());
    if (failed == 0) failed = std::rename(fresh.c_str(), path.c_str());
  }
  if (failed != 0) return cannot_be_written(path);
  const Status status = sync_names(files::path(path).parent_path().string());
  if (replaces && status.ok()) files::remove_all(old, error);
  return status;
}

}  // namespace bpa::io
