#include "mocap_bridge/sources/qualisys/parser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <pugixml.hpp>

#include "common/core/rotation.h"

namespace roundabout::mocap_bridge::qualisys {

namespace {

using Cursor = LittleEndianCursor;

constexpr double kDegree = std::numbers::pi / 180.0;

bool hasMatrix(Component component) {
  return component == Component::k6D || component == Component::k6DResidual;
}

bool hasResidual(Component component) {
  return component == Component::k6DResidual || component == Component::k6DEulerResidual;
}

bool isBodies(Component component) {
  return hasMatrix(component) || hasResidual(component) || component == Component::k6DEuler;
}

std::size_t bodyBytes(Component component) {
  return 4 * (3 + (hasMatrix(component) ? 9U : 3U) + (hasResidual(component) ? 1U : 0U));
}

std::array<double, 9> matrixOf(const Eigen::Vector3d& degrees) {
  const Eigen::Matrix3d matrix = core::fromIntrinsicXyz(kDegree * degrees).toRotationMatrix();
  std::array<double, 9> values;
  std::copy_n(matrix.data(), 9, values.begin());  // Eigen is column-major too
  return values;
}

Body readBody(Cursor& cursor, Component component) {
  Body body;
  const auto number = [&] { return static_cast<double>(cursor.read<float>()); };
  for (double& value : body.position_mm) {
    value = number();
  }
  if (hasMatrix(component)) {
    for (double& value : body.rotation) {
      value = number();
    }
  } else {
    const double x = number();
    const double y = number();
    body.rotation = matrixOf({x, y, number()});
  }
  body.residual_mm = hasResidual(component) ? number() : std::numeric_limits<double>::quiet_NaN();
  body.tracked = !std::isnan(body.position_mm[0]);
  return body;
}

const char* readBodies(Cursor& cursor, Component component, Data& data) {
  const auto claimed = cursor.read<std::uint32_t>();
  cursor.skip(4);  // rates of loss
  const std::size_t bytes = bodyBytes(component);
  if (cursor.failed() || claimed > cursor.remaining() / bytes ||
      claimed * bytes != cursor.remaining()) {
    return "a component's count does not fit its size";
  }
  if (data.has_bodies && !hasMatrix(component)) {
    return nullptr;  // what a rotation matrix has told already
  }
  data.has_bodies = true;
  data.bodies.clear();
  for (std::uint32_t i = 0; i < claimed; ++i) {
    data.bodies.push_back(readBody(cursor, component));
  }
  return nullptr;
}

void writeBody(LittleEndianWriter& writer, const Body& body, Component component) {
  const auto number = [&](double value) {
    writer.put(static_cast<float>(body.tracked ? value : std::numeric_limits<double>::quiet_NaN()));
  };
  for (const double value : body.position_mm) {
    number(value);
  }
  if (hasMatrix(component)) {
    for (const double value : body.rotation) {
      number(value);
    }
  } else {
    const Eigen::Map<const Eigen::Matrix3d> turned(body.rotation.data());
    number(std::atan2(-turned(1, 2), turned(2, 2)) / kDegree);
    number(std::asin(std::clamp(turned(0, 2), -1.0, 1.0)) / kDegree);
    number(std::atan2(-turned(0, 1), turned(0, 0)) / kDegree);
  }
  if (hasResidual(component)) {
    number(body.residual_mm);
  }
}

}  // namespace

std::optional<Packet> takePacket(Bytes& stream, bool& broken) {
  Cursor cursor(stream);
  const std::size_t size = cursor.read<std::uint32_t>();
  const auto type = cursor.read<std::uint32_t>();
  broken = stream.size() >= 4 && (size < kHeaderBytes || size > kLongestPacket);
  if (broken || cursor.failed() || stream.size() < size) {
    return std::nullopt;
  }
  const Packet packet{static_cast<PacketType>(type),
                      stream.subspan(kHeaderBytes, size - kHeaderBytes)};
  stream = stream.subspan(size);
  return packet;
}

const char* parseData(Bytes payload, Data& data) {
  Cursor cursor(payload);
  data.timestamp_us = cursor.read<std::uint64_t>();
  data.frame = cursor.read<std::uint32_t>();
  data.has_bodies = false;
  data.bodies.clear();
  const auto components = cursor.read<std::uint32_t>();
  for (std::uint32_t i = 0; i < components && !cursor.failed(); ++i) {
    const auto size = cursor.read<std::uint32_t>();
    const auto type = static_cast<Component>(cursor.read<std::uint32_t>());
    if (size < kHeaderBytes) {
      return "a component is shorter than its header";
    }
    Cursor component(cursor.take(size - kHeaderBytes));
    if (!cursor.failed() && isBodies(type)) {
      if (const char* reason = readBodies(component, type, data)) {
        return reason;
      }
    }
  }
  if (cursor.failed()) {
    return "shorter than its components say";
  }
  return cursor.remaining() > 0 ? "longer than its components say" : nullptr;
}

std::string parseText(Bytes payload) {
  return std::string(Cursor(payload).readText(payload.size()));
}

std::optional<std::vector<std::string>> parseBodyNames(Bytes payload) {
  const std::string text = parseText(payload);
  pugi::xml_document document;
  if (!document.load_buffer(text.data(), text.size())) {
    return std::nullopt;
  }
  const pugi::xml_node root = document.document_element();
  const pugi::xml_node bodies = root.child("The_6D");
  if (!std::string_view(root.name()).starts_with("QTM_Parameters_Ver_") || !bodies) {
    return std::nullopt;
  }
  std::vector<std::string> names;
  for (const pugi::xml_node& body : bodies.children("Body")) {
    names.emplace_back(body.child("Name").text().as_string());
  }
  return names;
}

std::vector<std::byte> writePacket(PacketType type, Bytes payload) {
  LittleEndianWriter writer;
  writer.put(static_cast<std::uint32_t>(kHeaderBytes + payload.size()));
  writer.put(static_cast<std::uint32_t>(type));
  writer.put(payload);
  return writer.bytes();
}

std::vector<std::byte> writeText(PacketType type, std::string_view text) {
  LittleEndianWriter payload;
  payload.putText(text);
  return writePacket(type, payload.bytes());
}

std::vector<std::byte> writeData(const Data& data, Component component) {
  LittleEndianWriter payload;
  payload.put(data.timestamp_us);
  payload.put(data.frame);
  payload.put<std::uint32_t>(1);
  payload.put(
      static_cast<std::uint32_t>(kHeaderBytes + 8 + data.bodies.size() * bodyBytes(component)));
  payload.put(static_cast<std::uint32_t>(component));
  payload.put(static_cast<std::uint32_t>(data.bodies.size()));
  payload.put<std::uint32_t>(0);
  for (const Body& body : data.bodies) {
    writeBody(payload, body, component);
  }
  return writePacket(PacketType::kData, payload.bytes());
}

}  // namespace roundabout::mocap_bridge::qualisys
