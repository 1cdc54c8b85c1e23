// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Preloaded into a process (LD_PRELOAD), this ends it as a power cut would: with exit code 99
// before the Nth call that changes files, N being BPA_POWER_CUT_AT. What was written to a file and
// not synced is lost then: the file is empty, whatever its name is by now.
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

namespace {

std::map<int, std::string> open_files;  // that are written to
std::map<std::string, bool> files;      // by their name now: whether they are synced

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

void change() {
  static const char* const text = std::getenv("BPA_POWER_CUT_AT");
  static int left = text == nullptr ? 0 : std::atoi(text);
  if (text == nullptr || --left > 0) return;
  for (const auto& [name, synced] : files) {
    if (!synced && truncate(name.c_str(), 0) != 0) std::_Exit(98);
  }
  std::_Exit(99);
}

void renamed(const std::string& from, const std::string& to, bool exchange) {
  std::map<std::string, bool> after;
  for (const auto& [name, synced] : files) {
    const auto moved = [&name = name](const std::string& a, const std::string& b) {
      const bool below = name == a || name.rfind(a + "/", 0) == 0;
      return below ? b + name.substr(a.size()) : std::string();
    };
    std::string new_name = moved(from, to);
    if (new_name.empty() && exchange) new_name = moved(to, from);
    if (new_name.empty() && name == to) continue;  // replaced
    after[new_name.empty() ? name : new_name] = synced;
  }
  files = after;
}

}  // namespace

extern "C" int open(const char* path, int flags, ...) {
  static auto* const real = next<int(const char*, int, ...)>("open");
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  if (writes) change();
  const int file = real(path, flags, mode);
  if (writes && file >= 0) {
    open_files[file] = path;
    files[path] = false;
  }
  return file;
}
extern "C" int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  return open(path, flags, mode);
}

extern "C" ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, std::size_t, off_t)>("pwrite");
  change();
  files[open_files[file]] = false;
  return real(file, bytes, size, at);
}
extern "C" ssize_t pwrite64(int file, const void* bytes, std::size_t size, off_t at) {
  return pwrite(file, bytes, size, at);
}

extern "C" int fsync(int file) {
  static auto* const real = next<int(int)>("fsync");
  change();
  const auto of = open_files.find(file);
  if (of != open_files.end()) files[of->second] = true;
  return real(file);
}

extern "C" int close(int file) {
  static auto* const real = next<int(int)>("close");
  open_files.erase(file);
  return real(file);
}

extern "C" int rename(const char* from, const char* to) {
  static auto* const real = next<int(const char*, const char*)>("rename");
  change();
  const int failed = real(from, to);
  if (failed == 0) renamed(from, to, false);
  return failed;
}

extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                         unsigned flags) {
  static auto* const real = next<int(int, const char*, int, const char*, unsigned)>("renameat2");
  change();
  const int failed = real(from_folder, from, to_folder, to, flags);
  if (failed == 0) renamed(from, to, (flags & RENAME_EXCHANGE) != 0);
  return failed;
}

extern "C" int unlinkat(int folder, const char* path, int flags) {
  static auto* const real = next<int(int, const char*, int)>("unlinkat");
  change();
  return real(folder, path, flags);
}
