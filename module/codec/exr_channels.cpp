#include "codec/exr_channels.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "codec/byte_file.h"

namespace welkin::codec {
namespace {

using Kind = ExrChannels::Kind;

// How programs spell the three colours. "red" is Nuke's in layers.
constexpr std::array<std::array<const char*, 3>, 4> kSpellings{{
    {"R", "G", "B"},
    {"r", "g", "b"},
    {"red", "green", "blue"},
    {"Red", "Green", "Blue"},
}};

struct Layer {
  std::string name;
  ExrChannels channels;
};

[[noreturn]] void refuse(const EnvironmentInfo& info, const std::string& found_and_remedy) {
  throw file_error(ErrorCode::unsupported_file, info.path, found_and_remedy);
}

// "half", "float" or "uint"
const char* type_name(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT: return "uint";
    case Imf::HALF: return "half";
    case Imf::FLOAT: return "float";
    default: return "unknown";
  }
}

std::string channel_names(const EnvironmentInfo& info) {
  std::string names;
  for (const ChannelInfo& channel : info.channels) {
    names += (names.empty() ? "" : ", ") + channel.name;
  }
  return printable(names);
}

std::string layer_of(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? "" : channel.substr(0, dot);
}

// The names before the last dot, "" first, each once. Channels are sorted by name, but not by layer.
std::vector<std::string> layer_names(const Imf::ChannelList& channels) {
  std::vector<std::string> names;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    names.push_back(layer_of(channel.name()));
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::optional<ExrChannels> picture_in(const Imf::ChannelList& channels, const std::string& layer) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  const auto has = [&](const char* name) { return channels.findChannel(prefix + name) != nullptr; };
  for (const auto& [red, green, blue] : kSpellings) {
    if (has(red) && has(green) && has(blue)) {
      return ExrChannels{Kind::colour, {prefix + red, prefix + green, prefix + blue}};
    }
  }
  if (!has("Y") || (has("X") && has("Z"))) {
    return std::nullopt;
  }
  if (has("RY") || has("BY")) {
    return ExrChannels{Kind::luminance_chroma, {prefix + "RY", prefix + "Y", prefix + "BY"}};
  }
  return ExrChannels{Kind::luminance, {prefix + "Y", "", ""}};
}

std::vector<Layer> find_pictures(const Imf::ChannelList& channels) {
  std::vector<Layer> found;
  for (const std::string& name : layer_names(channels)) {
    if (const std::optional<ExrChannels> picture = picture_in(channels, name)) {
      found.push_back({name, *picture});
    }
  }
  return found;
}

std::string list_layers(const std::vector<Layer>& layers) {
  std::string list;
  for (const Layer& layer : layers) {
    list += (list.empty() ? "" : ", ") + (layer.name.empty() ? std::string("the one without a name") : layer.name);
  }
  return printable(list);
}

const Layer& find_layer(const EnvironmentInfo& info, const std::vector<Layer>& layers, const std::string& asked_for) {
  const auto layer = std::find_if(layers.begin(), layers.end(), [&](const Layer& candidate) {
    return candidate.name == asked_for || printable(candidate.name) == asked_for;
  });
  if (layer == layers.end()) {
    refuse(info, "has no layer \"" + printable(asked_for) + "\" with R, G and B or Y (channels " + channel_names(info) +
                     "); " +
                     (info.layers.empty() ? "leave --layer out" : "pass --layer with one of: " + list_layers(layers)));
  }
  return *layer;
}

const Layer& choose_layer(const EnvironmentInfo& info, const std::vector<Layer>& layers) {
  if (layers.empty()) {
    refuse(info, "has channels " + channel_names(info) +
                     "; R, G and B, or Y alone or with RY and BY, are read: rename or convert the channels");
  }
  if (layers.front().name.empty() || layers.size() == 1) {
    return layers.front();
  }
  const auto in_colour = [](const Layer& layer) { return layer.channels.kind != Kind::luminance; };
  const auto first = std::find_if(layers.begin(), layers.end(), in_colour);
  if (first == layers.end() || std::any_of(first + 1, layers.end(), in_colour)) {
    refuse(info, "has several layers; pass --layer with one of: " + list_layers(layers));
  }
  return *first;
}

void require_sampling(const EnvironmentInfo& info, const std::string& name, const Imf::Channel& channel, int wanted) {
  if (channel.xSampling != wanted || channel.ySampling != wanted) {
    refuse(info, "channel " + printable(name) + " is sampled at every " + std::to_string(channel.xSampling) + " x " +
                     std::to_string(channel.ySampling) + " texels where " + std::to_string(wanted) + " x " +
                     std::to_string(wanted) + (wanted == 1 ? " is" : " (luminance-chroma) is") +
                     " read; save it as R, G and B at full resolution");
  }
}

void require_usable(const EnvironmentInfo& info, const ExrChannels& chosen, const Imf::ChannelList& channels) {
  for (std::size_t i = 0; i < chosen.names.size(); ++i) {
    const Imf::Channel* channel = chosen.names[i].empty() ? nullptr : channels.findChannel(chosen.names[i]);
    if (channel != nullptr) {
      const bool chroma = chosen.kind == Kind::luminance_chroma && i != 1;
      require_sampling(info, chosen.names[i], *channel, chroma ? 2 : 1);
    }
  }
}

}  // namespace

bool holds_picture(const Imf::ChannelList& channels, const std::string& layer, bool in_colour) {
  const std::vector<Layer> layers = find_pictures(channels);
  return std::any_of(layers.begin(), layers.end(), [&](const Layer& found) {
    return (layer.empty() || found.name == layer || printable(found.name) == layer) &&
           (!in_colour || found.channels.kind != Kind::luminance);
  });
}

ExrChannels choose_exr_channels(EnvironmentInfo& info, const Imf::ChannelList& channels, const std::string& layer) {
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    info.channels.push_back({printable(channel.name()), type_name(channel.channel().type)});
  }
  const std::vector<Layer> layers = find_pictures(channels);
  for (const Layer& found : layers) {
    if (!found.name.empty()) {
      info.layers.push_back(printable(found.name));
    }
  }
  const ExrChannels& chosen = (layer.empty() ? choose_layer(info, layers) : find_layer(info, layers, layer)).channels;
  require_usable(info, chosen, channels);
  return chosen;
}

}  // namespace welkin::codec
