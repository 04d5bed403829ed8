#include "importer/gltf/json_tree.h"

#include <algorithm>
#include <vector>

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

// Hands what the parser meets to the place where it belongs.
class TreeBuilder {
 public:
  explicit TreeBuilder(Json& root) : slot_(&root) {}

  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(Json::number_integer_t value) { return put(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return put(value); }
  bool number_float(Json::number_float_t value, const std::string&) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(Json::binary_t&) { return false; }  // there is none in text
  bool start_object(size_t) { return open(Json::value_t::object); }
  bool start_array(size_t) { return open(Json::value_t::array); }
  bool key(std::string& name) {
    slot_ = &memberOf(*open_.back(), name);
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool parse_error(size_t, const std::string&, const nlohmann::detail::exception&) { return false; }

 private:
  Json& place() {
    Json& value = !open_.empty() && open_.back()->is_array() ? appendTo(*open_.back()) : *slot_;
    setNull(value);  // the last of several members of one name counts
    return value;
  }
  template <class Value>
  bool put(Value&& value) {
    place() = std::forward<Value>(value);
    return true;
  }
  bool open(Json::value_t type) {
    Json& value = place();
    value = type;
    open_.push_back(&value);
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  Json* slot_;               // of the next value, unless that is an array's element
  std::vector<Json*> open_;  // arrays and objects, from the root on
};

}  // namespace

void takeApart(Json& value) noexcept {
  if (value.is_object())
    for (auto& [name, child] : value.get_ref<Json::object_t&>()) takeApart(child);
  if (value.is_array())
    for (Json& child : value.get_ref<Json::array_t&>()) takeApart(child);
  if (value.is_structured()) value.clear();
}

bool parseInto(Json& root, std::string_view text) {
  TreeBuilder builder(root);
  return Json::sax_parse(text, &builder);
}

void setNull(Json& value) noexcept {
  takeApart(value);
  value = nullptr;
}

Json& memberOf(Json& object, const std::string& key) {
  using Members = Json::object_t;
  if (object.is_null()) object = Json::value_t::object;
  auto& members = object.get_ref<Members&>();
  if (const auto found = members.find(key); found != members.end()) return found->second;
  if (members.size() == members.capacity()) {
    Members larger;
    larger.reserve(std::max<size_t>(4, 2 * members.size()));
    for (const auto& [name, value] : members) larger.emplace_back(name, nullptr);
    auto next = larger.begin();
    for (auto& [name, value] : members) (next++)->second.swap(value);
    members.swap(larger);
  }
  members.emplace_back(key, nullptr);
  return members.back().second;
}

Json& listOf(Json& object, const std::string& key) {
  Json& list = memberOf(object, key);
  if (list.is_array()) return list;
  setNull(list);
  return list = Json::value_t::array;
}

void setNumbers(Json& value, std::initializer_list<double> numbers) {
  setNull(value);
  value = Json::value_t::array;
  for (const double number : numbers) appendTo(value) = number;
}

Json& appendTo(Json& array) {
  array.get_ref<Json::array_t&>().emplace_back(nullptr);
  return array.back();
}

}  // namespace loden::importer
