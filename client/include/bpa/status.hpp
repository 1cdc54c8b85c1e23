// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Status and Result<T>: what every call of the SDK returns. A Status is a code and one sentence; a
// Result is a value or a Status. Both are [[nodiscard]].
#include "core/base/status.hpp"
