// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// All message and service types.
#include <bpa/wire/msg/bpa_msgs.hpp>
#include <bpa/wire/msg/bpa_srvs.hpp>
#include <bpa/wire/msg/builtin_interfaces.hpp>
#include <bpa/wire/msg/diagnostic_msgs.hpp>
#include <bpa/wire/msg/geometry_msgs.hpp>
#include <bpa/wire/msg/rcl_interfaces.hpp>
#include <bpa/wire/msg/rmw_dds_common.hpp>
#include <bpa/wire/msg/sensor_msgs.hpp>
#include <bpa/wire/msg/std_msgs.hpp>
#include <bpa/wire/msg/std_srvs.hpp>
#include <bpa/wire/msg/tf2_msgs.hpp>
#include <bpa/wire/msg/vision_msgs.hpp>
#include <bpa/wire/msg/visualization_msgs.hpp>
