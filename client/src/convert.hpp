// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bpa/status.hpp>
#include <bpa/types.hpp>

#include "idl/wire/messages.hpp"

// The SDK's structs <-> messages.

namespace bpa::sdk {

ObjectPose to_pose(const wire::geometry_msgs::Pose& message);
wire::geometry_msgs::Pose to_message(const ObjectPose& pose);
DetectionSet to_detections(const wire::bpa_msgs::SceneInterpretations& message);
/// A state that this version does not know is `tentative`.
TrackSet to_tracks(const wire::bpa_msgs::Tracks& message);
KnownModel to_model(const wire::bpa_msgs::ModelInfo& message);
ServerStatus to_server_status(const wire::bpa_msgs::GetStatus_Response& message);
/// Fails unless it is an rgb8 image whose pixels are all there, rows without padding.
Result<AnnotatedImage> to_image(wire::sensor_msgs::Image&& message);

/// Checks what would otherwise be read beyond its end; the rest is the server's to judge.
Status check(const FrameView& frame);
/// A frame of another client, pointing to the message's pixels. Fails on other encodings than the
/// SDK writes (rgb8, 16UC1, 32FC1) and on pixels that are not all there.
Result<FrameView> to_view(const wire::bpa_msgs::RgbdFrame& message);
/// The frame as a message that points to the caller's pixels.
wire::bpa_msgs::RgbdFrameView to_message(const FrameView& frame);
/// The same with copies of the pixels.
wire::bpa_msgs::RgbdFrame to_owned_message(const FrameView& frame);

/// Checks the weights, of which 0 means the default on the wire; the rest is the server's to judge.
Result<std::vector<wire::bpa_msgs::PosePrior>> to_messages(const std::vector<ExpectedPose>& priors);

}  // namespace bpa::sdk
