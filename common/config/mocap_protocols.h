#pragma once

/// The table of motion-capture protocols, in the order in which users are told of them: what an
/// experiment file calls each, and the folder of mocap_bridge/sources/ and namespace of its
/// protocol().
#define ROUNDABOUT_MOCAP_PROTOCOLS(ENTRY) \
  ENTRY(natnet)                           \
  ENTRY(qualisys)                         \
  ENTRY(vrpn)                             \
  ENTRY(vicon_udp)
