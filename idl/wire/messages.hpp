// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// All message and service types.
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/bpa_srvs.hpp"
#include "idl/wire/msg/builtin_interfaces.hpp"
#include "idl/wire/msg/diagnostic_msgs.hpp"
#include "idl/wire/msg/geometry_msgs.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "idl/wire/msg/rmw_dds_common.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"
#include "idl/wire/msg/std_msgs.hpp"
#include "idl/wire/msg/std_srvs.hpp"
#include "idl/wire/msg/tf2_msgs.hpp"
#include "idl/wire/msg/vision_msgs.hpp"
#include "idl/wire/msg/visualization_msgs.hpp"
