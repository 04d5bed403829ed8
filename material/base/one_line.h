// Puts the message of another library on one line, for the text of an Issue.
#pragma once

#include <algorithm>
#include <string>

namespace loden {

// The first 500 bytes of the text at most. Each line break and control character becomes a space, and
// trailing spaces are removed.
inline std::string oneLine(std::string text) {
  text.resize(std::min<size_t>(text.size(), 500));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = ' ';
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace loden
