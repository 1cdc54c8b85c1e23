// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/log.hpp"

namespace bpa {

void log(const LogHook& hook, LogLevel level, std::string_view message) {
  if (hook) hook(level, message);
}

}  // namespace bpa
