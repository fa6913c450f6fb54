// Which of an OpenEXR part's channels make the picture.
#pragma once

#include <ImfChannelList.h>

#include <array>
#include <string>

#include "welkin/environment_file.h"

namespace welkin::codec {

struct ExrChannels {
  enum class Kind {
    colour,            ///< names: red, green, blue
    luminance,         ///< names[0]: Y
    luminance_chroma,  ///< names: RY, Y, BY; one of the chroma channels may be absent
  };
  Kind kind = Kind::colour;
  std::array<std::string, 3> names{};
};

/// A layer is what stands before a channel's last dot: "env" of "env.R", "a.b" of "a.b.R". Views other than the
/// default one of a multi-view file are named the same way ("left.R"), and are layers here.
///
/// A layer is a picture if it has R, G and B (also written r g b, red green blue, Red Green Blue, as compositors do)
/// or else Y, perhaps with RY and BY. X, Y and Z together are a vector, as renderers write for normals and positions,
/// and no picture. Alpha, depth and the like are read past; colour is taken as it is, premultiplied or not.

/// Whether there is a picture in `layer` (in any, if that is empty): one in colour, or any other.
[[nodiscard]] bool holds_picture(const Imf::ChannelList& channels, const std::string& layer, bool in_colour);

/// Fills in `info.channels` and `info.layers` and chooses: the layer that is asked for; else the channels without
/// one; else the only layer in colour; else the only layer. Needs `info.path`.
/// uint is read as the numbers that it states, as half and float are.
/// Throws `Error` (unsupported_file) naming what there is and, if layers are to choose from, --layer.
[[nodiscard]] ExrChannels choose_exr_channels(EnvironmentInfo& info, const Imf::ChannelList& channels,
                                              const std::string& layer);

}  // namespace welkin::codec
