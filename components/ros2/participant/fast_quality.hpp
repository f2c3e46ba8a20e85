// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/node_graph.hpp>
#include <segue/ros2/quality.hpp>

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/publisher/qos/WriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/subscriber/qos/ReaderQos.hpp>

#include <string>

/// Qualities of ROS 2 as Fast DDS has them.
namespace ros2 {

namespace dds = eprosima::fastdds::dds;

dds::DataWriterQos writer_quality(const segue::ros2::Quality& quality, const std::string& user_data);
dds::DataReaderQos reader_quality(const segue::ros2::Quality& quality, const std::string& user_data);

/// The qualities and the user data that another endpoint says it has.
segue::ros2::Quality quality_of(const dds::WriterQos& quality);
segue::ros2::Quality quality_of(const dds::ReaderQos& quality);
std::string user_data_of(const dds::WriterQos& quality);
std::string user_data_of(const dds::ReaderQos& quality);

}  // namespace ros2
