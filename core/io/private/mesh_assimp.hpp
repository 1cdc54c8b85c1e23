// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"
#include "core/cloud/point_cloud.hpp"

namespace bpa::io {

/// Reads OBJ and STL with Assimp, in the file's unit. Fails with corrupt, naming the file.
Result<TriangleMesh> read_mesh_with_assimp(const std::string& path);

}  // namespace bpa::io
