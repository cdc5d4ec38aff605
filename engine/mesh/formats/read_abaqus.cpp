#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numbers>
#include <set>

#include "engine/mesh/formats/abaqus_input.h"
#include "systems/collision/build_surface.h"

// Reader of Abaqus input files (.inp). Format: Abaqus Keywords Reference Guide. It reads nodes, tetrahedra and
// triangles of first and second order, sets of nodes and elements, surfaces, solid sections, and instances of parts.
// All other keywords are skipped.
namespace skerry::mesh {
namespace {

/// Number of nodes of an element type. If elements of the type are not read, the number is 0, and `name` is a plural
/// noun for messages.
struct AbaqusKind {
    std::size_t nodes = 0;
    std::string name{};
};

AbaqusKind kind_of(const std::string& type) {
    const auto leading_number = [](std::string_view text) {
        std::size_t digits = 0;
        while (digits < text.size() && text[digits] >= '0' && text[digits] <= '9') ++digits;
        return std::string(text.substr(0, digits));
    };
    // Types of solid elements contain C3D and the number of nodes, as in C3D10M and DC3D4.
    if (const std::size_t at = type.find("C3D"); at <= 1) {
        const std::string nodes = leading_number(std::string_view(type).substr(at + 3));
        if (nodes == "4") return {.nodes = 4};
        if (nodes == "10") return {.nodes = 10};
        if (nodes == "5") return {.name = "pyramids"};
        if (nodes == "6" || nodes == "15") return {.name = "prisms"};
        if (nodes == "8" || nodes == "20" || nodes == "27") return {.name = "hexahedra"};
    }
    if (type == "STRI65") return {.nodes = 6};
    for (const char* family : {"SFM3D", "R3D", "M3D", "STRI", "CPS", "CPE", "DS", "S"}) {
        if (!type.starts_with(family)) continue;
        const std::string nodes = leading_number(std::string_view(type).substr(std::string_view(family).size()));
        if (nodes == "3" || nodes == "6") return {.nodes = nodes == "3" ? 3u : 6u};
    }
    return {.name = "elements of type " + type};
}

/// A section of the file with its own numbering of nodes and elements: an instance, a part if the file has no
/// instances, or everything outside of these.
struct AbaqusScope {
    std::string prefix{};  // first part of the names of its sets, for example "Part-1-1."
    std::size_t first_node = 0;
    NodeNumbers nodes{};  // NodeNumbers::row() plus first_node is the index of a node in mesh_.nodes
    std::unordered_map<std::int64_t, std::size_t> element{};  // index in elements_ by the number of an element
};

struct AbaqusElement {
    std::size_t nodes;       // 4, 10, 3, 6, or 0 if the element is not read
    Index row;               // index in mesh_.tetrahedra or mesh_.triangles
    std::size_t first, end;  // range of its nodes in element_nodes_
};

/// A set of nodes or of elements.
struct AbaqusSet {
    std::string name{};
    bool internal = false;               // has the parameter INTERNAL; such a set is left out of the mesh
    std::vector<std::size_t> members{};  // indices in mesh_.nodes, or in elements_
};

class AbaqusReader {
public:
    explicit AbaqusReader(FileReader& reader) : reader_(reader), blocks_(abaqus_blocks(reader)) {}

    RawMesh read() {
        for (const AbaqusBlock& block : blocks_) require_plain(block);
        for (const Instance& instance : instances()) read_scope(instance);
        reader_.set_section({});
        if (mesh_.nodes.empty()) reader_.complain({}, "no nodes", "at least one node after a keyword *NODE");
        take_node_sets();
        take_element_sets();
        take_surfaces();
        note_labels();
        return std::move(mesh_);
    }

private:
    /// Blocks of one scope (see AbaqusScope). For an instance of a part, `pose` is its block *INSTANCE, with the
    /// translation and the rotation of the nodes.
    struct Instance {
        std::string prefix{};
        std::vector<const AbaqusBlock*> blocks{};
        const AbaqusBlock* pose = nullptr;  // null: the nodes are not moved
    };

    /// Refuses keywords and parameters with which a file generates or includes nodes, elements or sets instead of
    /// listing them. Also refuses coordinates that are not Cartesian.
    void require_plain(const AbaqusBlock& block) {
        static const std::set<std::string> makers{"NGEN",  "NFILL",  "NCOPY",  "NMAP",
                                                  "ELGEN", "ELCOPY", "SYSTEM", "INCLUDE"};
        const bool mesh = block.keyword == "NODE" || block.keyword == "ELEMENT" || block.keyword == "NSET" ||
                          block.keyword == "ELSET";
        const std::string system = in_upper_case(block.value("SYSTEM"));
        go_to_keyword(reader_, block);
        if (makers.contains(block.keyword) || (mesh && block.has("INPUT")))
            reader_.complain({}, mesh ? "the parameter INPUT" : "the keyword *" + block.keyword,
                             "all nodes, elements and sets listed in this file, in Cartesian coordinates",
                             "import the file into Abaqus or another program and write its mesh again");
        if (block.keyword == "NODE" && !system.empty() && system != "R")
            reader_.complain("SYSTEM", in_quotes(system), "R (Cartesian coordinates)");
    }

    /// Lists the instances in the order of the file, then everything outside of parts and instances. In a file without
    /// instances, each part counts as an instance.
    std::vector<Instance> instances() {
        std::map<std::string, Instance> parts;  // by name in lower case
        std::vector<std::string> part_order;
        std::vector<Instance> all;
        Instance rest;
        Instance* open = &rest;
        for (const AbaqusBlock& block : blocks_) {
            if (block.keyword == "PART") {
                const std::string name = block.value("NAME");
                const auto [place, added] = parts.try_emplace(in_lower_case(name));
                if (added) part_order.push_back(place->first);
                open = &place->second;
                open->prefix = name + ".";
            } else if (block.keyword == "INSTANCE") {
                const auto part = parts.find(in_lower_case(block.value("PART")));
                go_to_keyword(reader_, block);
                if (part == parts.end())
                    reader_.complain("PART", in_quotes(block.value("PART")),
                                     "the name of a part that is defined above");
                all.push_back(part->second);
                open = &all.back();
                open->prefix = block.value("NAME") + ".";
                open->pose = &block;
            } else if (block.keyword == "END PART" || block.keyword == "END INSTANCE") {
                open = &rest;
            } else {
                open->blocks.push_back(&block);
            }
        }
        if (all.empty())
            for (const std::string& name : part_order) all.push_back(parts[name]);
        all.push_back(rest);
        return all;
    }

    void read_scope(const Instance& instance) {
        const std::string key = in_lower_case(instance.prefix);
        const auto [place, added] = scopes_.try_emplace(key);
        if (instance.pose != nullptr) go_to_keyword(reader_, *instance.pose);
        if (!added) reader_.complain("NAME", "a second instance " + in_quotes(instance.prefix), "different names");
        AbaqusScope& scope = place->second;
        scope.prefix = instance.prefix;
        scope.first_node = mesh_.nodes.size();
        const auto for_each = [&](const char* keyword, auto&& read) {
            for (const AbaqusBlock* block : instance.blocks)
                if (block->keyword == keyword) read(*block);
        };
        for_each("NODE", [&](const AbaqusBlock& block) { read_nodes(block, scope); });
        if (mesh_.nodes.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max() / 4))
            reader_.complain({}, std::to_string(mesh_.nodes.size()) + " nodes in all instances",
                             "at most " + std::to_string(std::numeric_limits<Index>::max() / 4));
        if (instance.pose != nullptr) move_nodes(*instance.pose, scope);
        for_each("ELEMENT", [&](const AbaqusBlock& block) { read_elements(block, scope); });
        for_each("ELSET", [&](const AbaqusBlock& block) { read_set(block, element_sets_, scope); });
        for_each("NSET", [&](const AbaqusBlock& block) { read_set(block, node_sets_, scope); });
        for_each("SURFACE", [&](const AbaqusBlock& block) { read_surface(block, scope); });
        for_each("SOLID SECTION", [&](const AbaqusBlock& block) { read_section(block, scope); });
    }

    Real number(const std::string& field, const char* meaning) {
        return reader_.finite(reader_.parse_real(field, meaning), meaning);
    }

    void read_nodes(const AbaqusBlock& block, AbaqusScope& scope) {
        AbaqusSet* set = block.has("NSET") ? &set_of(node_sets_, block.value("NSET"), scope) : nullptr;
        for_each_abaqus_row(reader_, block, 1, [&](const std::vector<std::string>& row) {
            scope.nodes.add(reader_.parse_integer(row[0], "number"), reader_);
            Vec3 x = Vec3::Zero();  // an empty field means zero
            for (std::size_t a = 0; a < 3; ++a)
                if (a + 1 < row.size() && !row[a + 1].empty())
                    x[static_cast<Eigen::Index>(a)] = number(row[a + 1], "position");
            if (set != nullptr) set->members.push_back(mesh_.nodes.size());
            mesh_.nodes.push_back(x);
        });
    }

    /// Moves the nodes of an instance: first by a translation, then by a rotation around an axis through two points.
    void move_nodes(const AbaqusBlock& pose, const AbaqusScope& scope) {
        Eigen::Transform<Real, 3, Eigen::Isometry> motion = Eigen::Transform<Real, 3, Eigen::Isometry>::Identity();
        for_each_abaqus_row(reader_, pose, 1, [&](const std::vector<std::string>& row) {
            if (row.size() != 3 && row.size() != 7)
                reader_.complain({}, std::to_string(row.size()) + " numbers",
                                 "3 numbers of a translation, or 7 of a rotation: two points of its axis, and degrees");
            std::vector<Real> of_row;
            for (const std::string& field : row) of_row.push_back(number(field, "motion"));
            const Vec3 first(of_row[0], of_row[1], of_row[2]);
            if (row.size() == 3) {
                motion.pretranslate(first);
                return;
            }
            const Vec3 axis = Vec3(of_row[3], of_row[4], of_row[5]) - first;
            if (!(axis.norm() > 0)) reader_.complain("motion", "the same point twice", "two points of the axis");
            const Eigen::AngleAxis<Real> turn(of_row[6] * std::numbers::pi / 180, axis.normalized());
            motion.pretranslate(-first).prerotate(turn).pretranslate(first);
        });
        for (std::size_t n = scope.first_node; n < mesh_.nodes.size(); ++n) mesh_.nodes[n] = motion * mesh_.nodes[n];
    }

    void read_elements(const AbaqusBlock& block, AbaqusScope& scope) {
        const AbaqusKind kind = kind_of(in_upper_case(block.value("TYPE")));
        AbaqusSet* set = block.has("ELSET") ? &set_of(element_sets_, block.value("ELSET"), scope) : nullptr;
        std::vector<std::size_t> members;
        std::vector<Index> nodes;
        const std::size_t fields = kind.nodes > 0 ? kind.nodes + 1 : std::numeric_limits<std::size_t>::max();
        for_each_abaqus_row(reader_, block, fields, [&](const std::vector<std::string>& row) {
            if (kind.nodes > 0 && row.size() != fields)
                reader_.complain({}, std::to_string(row.size()) + " numbers",
                                 std::to_string(fields) + " numbers: number and nodes of an element");
            const std::int64_t own = reader_.parse_integer(row[0], "number");
            if (!scope.element.try_emplace(own, elements_.size()).second)
                reader_.complain("number", std::to_string(own) + ", the number of an earlier element",
                                 "a different number for every element");
            members.clear();
            for (std::size_t a = 1; a < row.size(); ++a) add_members(row[a], scope, node_sets_, members);
            nodes.assign(members.begin(), members.end());
            const bool tetrahedron = kind.nodes == 4 || kind.nodes == 10;
            AbaqusElement element{kind.nodes, no_index, element_nodes_.size(), element_nodes_.size() + nodes.size()};
            if (tetrahedron) {
                element.row = static_cast<Index>(mesh_.tetrahedra.size());
                take_tetrahedron(nodes, reader_, mesh_);
            } else if (kind.nodes > 0) {
                element.row = static_cast<Index>(mesh_.triangles.size());
                take_triangle(nodes, reader_, mesh_);
            } else {
                mesh_.others[kind.name] += 1;
            }
            element_nodes_.insert(element_nodes_.end(), nodes.begin(), nodes.end());
            if (set != nullptr) set->members.push_back(elements_.size());
            elements_.push_back(element);
        });
    }

    using Sets = std::map<std::string, AbaqusSet>;  // by name in lower case

    /// Returns the set of a scope with the given name, which is created if it is new.
    static AbaqusSet& set_of(Sets& sets, const std::string& name, const AbaqusScope& scope) {
        AbaqusSet& set = sets[in_lower_case(scope.prefix + name)];
        if (set.name.empty()) set.name = scope.prefix + name;
        return set;
    }

    /// Converts a number in the file to the index of a node in mesh_.nodes if `sets` is node_sets_, otherwise to the
    /// index of an element in elements_. Throws SceneError if no node or element has this number.
    std::size_t member(const std::string& number, const AbaqusScope& scope, const Sets& sets) {
        if (&sets == &node_sets_)
            return scope.first_node +
                   static_cast<std::size_t>(scope.nodes.row(reader_.parse_integer(number, "node"), reader_));
        const auto found = scope.element.find(reader_.parse_integer(number, "element"));
        if (found == scope.element.end())
            reader_.complain("element", number, "the number of an element that the file defines");
        return found->second;
    }

    /// Appends to `to` the members that an entry of a row names. The entry is the number of one member, or the name of
    /// an earlier set with all its members. The name of an instance and a dot may precede it.
    void add_members(const std::string& entry, const AbaqusScope& scope, const Sets& sets,
                     std::vector<std::size_t>& to) {
        const auto begins_number = [](std::string_view text) {
            return !text.empty() && text[0] >= '0' && text[0] <= '9';
        };
        if (begins_number(entry)) {
            to.push_back(member(entry, scope, sets));
            return;
        }
        const std::string full = in_lower_case(scope.prefix + entry);
        const std::size_t behind_dot = full.rfind('.') + 1;
        const auto other = scopes_.find(full.substr(0, behind_dot));
        if (other != scopes_.end() && begins_number(std::string_view(full).substr(behind_dot))) {
            to.push_back(member(full.substr(behind_dot), other->second, sets));
            return;
        }
        const auto set = sets.find(full);
        if (set == sets.end())
            reader_.complain({}, in_quotes(entry), "a number, or the name of a set that is defined above");
        to.insert(to.end(), set->second.members.begin(), set->second.members.end());
    }

    const AbaqusScope& scope_of(const AbaqusBlock& block, const AbaqusScope& scope) {
        if (!block.has("INSTANCE")) return scope;
        const auto found = scopes_.find(in_lower_case(block.value("INSTANCE")) + ".");
        if (found == scopes_.end()) {
            go_to_keyword(reader_, block);
            reader_.complain("INSTANCE", in_quotes(block.value("INSTANCE")), "the name of an instance");
        }
        return found->second;
    }

    /// Reads a block *NSET or *ELSET into `sets`.
    void read_set(const AbaqusBlock& block, Sets& sets, const AbaqusScope& scope) {
        AbaqusSet& set = set_of(sets, named(block, block.keyword.c_str()), scope);
        set.internal = set.internal || block.has("INTERNAL");
        const AbaqusScope& from = scope_of(block, scope);
        std::vector<std::size_t> members;
        if (block.keyword == "NSET" && block.has("ELSET")) {
            go_to_keyword(reader_, block);
            add_members(block.value("ELSET"), from, element_sets_, members);
            for (const std::size_t e : members)
                set.members.insert(set.members.end(),
                                   element_nodes_.begin() + static_cast<std::ptrdiff_t>(elements_[e].first),
                                   element_nodes_.begin() + static_cast<std::ptrdiff_t>(elements_[e].end));
            return;
        }
        for_each_abaqus_row(reader_, block, 1, [&](const std::vector<std::string>& row) {
            if (block.has("GENERATE")) {
                add_range(row, from, sets, members);
            } else {
                for (const std::string& entry : row)
                    if (!entry.empty()) add_members(entry, from, sets, members);
            }
        });
        set.members.insert(set.members.end(), members.begin(), members.end());
    }

    /// Appends to `to` the members that a row of *NSET or *ELSET with the parameter GENERATE describes by three
    /// numbers: first member, last member, and increment (1 if it is missing).
    void add_range(const std::vector<std::string>& row, const AbaqusScope& scope, const Sets& sets,
                   std::vector<std::size_t>& to) {
        if (row.size() < 2 || row.size() > 3)
            reader_.complain({}, std::to_string(row.size()) + " numbers", "first number, last number and step");
        const std::int64_t first = reader_.parse_integer(row[0], "first"), last = reader_.parse_integer(row[1], "last"),
                           step = row.size() < 3 || row[2].empty() ? 1 : reader_.parse_integer(row[2], "step");
        const std::size_t most = &sets == &node_sets_ ? scope.nodes.size() : scope.element.size();
        if (first < 1 || step < 1 || last < first || static_cast<std::uint64_t>((last - first) / step) >= most)
            reader_.complain({}, in_quotes(row[0] + ", " + row[1] + ", " + std::to_string(step)),
                             "first number, last number and step of at most " + std::to_string(most) + " numbers");
        for (std::int64_t number = first; number <= last; number += step)
            to.push_back(member(std::to_string(number), scope, sets));
    }

    /// Value of a parameter that must give a name. Throws SceneError if the parameter is missing or empty.
    std::string named(const AbaqusBlock& block, const char* parameter) {
        const std::string name = block.value(parameter);
        if (name.empty()) {
            go_to_keyword(reader_, block);
            reader_.complain(parameter, "no value", "a name");
        }
        return name;
    }

    void read_surface(const AbaqusBlock& block, const AbaqusScope& scope) {
        const std::string type = in_upper_case(block.value("TYPE")), name = scope.prefix + named(block, "NAME");
        if (block.has("COMBINE") || (!type.empty() && type != "ELEMENT" && type != "NODE")) {
            mesh_.notes.push_back("the surface " + in_quotes(name) +
                                  " is not a list of faces or nodes and was left out");
            return;
        }
        MeshSet& surface = surfaces_[name];
        if (block.has("INTERNAL")) internal_surfaces_.insert(name);
        std::vector<std::size_t> members;
        for_each_abaqus_row(reader_, block, 1, [&](const std::vector<std::string>& row) {
            members.clear();
            add_members(row[0], scope, type == "NODE" ? node_sets_ : element_sets_, members);
            if (type == "NODE")
                surface.nodes.insert(surface.nodes.end(), members.begin(), members.end());
            else
                for (const std::size_t e : members)
                    add_face(elements_[e], row.size() > 1 ? in_upper_case(row[1]) : "", surface);
        });
    }

    /// Adds a face of an element to a surface. `label` selects the face of a tetrahedron: S1 to S4. Without a label the
    /// tetrahedron is listed as a whole, and take_surfaces() later selects its faces on the boundary.
    void add_face(const AbaqusElement& element, const std::string& label, MeshSet& surface) {
        constexpr std::array<std::array<std::size_t, 3>, 4> faces{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
        const auto row = static_cast<std::size_t>(element.row);
        if (element.nodes == 3 || element.nodes == 6) {
            surface.faces.push_back(mesh_.triangles[row]);
        } else if (element.nodes > 0 && label.empty()) {
            surface.tetrahedra.push_back(element.row);
        } else if (element.nodes > 0) {
            if (label.size() != 2 || label[0] != 'S' || label[1] < '1' || label[1] > '4')
                reader_.complain("face", in_quotes(label), "S1, S2, S3 or S4 for a tetrahedron");
            const std::array<std::size_t, 3>& corner = faces[static_cast<std::size_t>(label[1] - '1')];
            const std::array<Index, 4>& t = mesh_.tetrahedra[row];
            surface.faces.push_back({t[corner[0]], t[corner[1]], t[corner[2]]});
        }
    }

    void read_section(const AbaqusBlock& block, const AbaqusScope& scope) {
        const std::string material = named(block, "MATERIAL"), elements = named(block, "ELSET");
        auto known = std::ranges::find_if(
            materials_, [&](const std::string& name) { return in_lower_case(name) == in_lower_case(material); });
        if (known == materials_.end()) known = materials_.insert(materials_.end(), material);
        const int label = static_cast<int>(known - materials_.begin()) + 1;
        std::vector<std::size_t> members;
        go_to_keyword(reader_, block);
        add_members(elements, scope, element_sets_, members);
        mesh_.label.resize(mesh_.tetrahedra.size());
        for (const std::size_t e : members)
            if (elements_[e].nodes == 4 || elements_[e].nodes == 10)
                mesh_.label[static_cast<std::size_t>(elements_[e].row)] = label;
    }

    void note_labels() {
        if (materials_.empty()) return;
        mesh_.label.resize(mesh_.tetrahedra.size());
        std::string text = "labels are numbers of materials, the constants of which are not read:";
        for (std::size_t m = 0; m < materials_.size(); ++m)
            text += (m == 0 ? " " : ", ") + std::to_string(m + 1) + " is " + in_quotes(materials_[m]);
        mesh_.notes.push_back(std::move(text));
    }

    void take_node_sets() {
        for (const auto& [key, set] : node_sets_)
            if (!set.internal) mesh_.sets[set.name].nodes.assign(set.members.begin(), set.members.end());
    }

    /// Adds the element sets to the mesh. If a node set has the same name, its nodes decide: if they are exactly the
    /// nodes of the elements, the element set replaces it; otherwise "_elements" is appended to the name of the element
    /// set.
    void take_element_sets() {
        for (const auto& [key, set] : element_sets_) {
            if (set.internal) continue;
            MeshSet taken;
            std::set<Index> nodes;
            for (const std::size_t e : set.members) {
                const AbaqusElement& element = elements_[e];
                const std::span<const Index> own =
                    std::span(element_nodes_).subspan(element.first, element.end - element.first);
                nodes.insert(own.begin(), own.end());
                if (element.nodes == 4 || element.nodes == 10)
                    taken.tetrahedra.push_back(element.row);
                else if (element.nodes > 0)
                    taken.faces.push_back(mesh_.triangles[static_cast<std::size_t>(element.row)]);
                else
                    taken.nodes.insert(taken.nodes.end(), own.begin(), own.end());
            }
            const auto same = mesh_.sets.find(set.name);
            const bool other = same != mesh_.sets.end() &&
                               std::set<Index>(same->second.nodes.begin(), same->second.nodes.end()) != nodes;
            mesh_.sets[set.name + (other ? "_elements" : "")] = std::move(taken);
        }
    }

    /// Adds the surfaces of the file to the mesh. For a tetrahedron that a surface lists as a whole, adds its faces on
    /// the boundary of the mesh.
    void take_surfaces() {
        const bool whole =
            std::ranges::any_of(surfaces_, [](const auto& item) { return !item.second.tetrahedra.empty(); });
        const std::vector<BoundaryTriangle> boundary =
            whole ? boundary_triangles(mesh_.tetrahedra) : std::vector<BoundaryTriangle>();
        for (auto& [name, surface] : surfaces_) {
            if (internal_surfaces_.contains(name)) continue;
            std::ranges::sort(surface.tetrahedra);
            for (const BoundaryTriangle& triangle : boundary)
                if (std::ranges::binary_search(surface.tetrahedra, triangle.element))
                    surface.faces.push_back(triangle.node);
            surface.tetrahedra.clear();
            mesh_.sets[name + (mesh_.sets.contains(name) ? "_surface" : "")] = std::move(surface);
        }
    }

    FileReader& reader_;
    std::vector<AbaqusBlock> blocks_;
    std::map<std::string, AbaqusScope> scopes_;  // by prefix in lower case
    std::vector<AbaqusElement> elements_;
    std::vector<Index> element_nodes_;
    Sets node_sets_, element_sets_;
    std::map<std::string, MeshSet> surfaces_;
    std::set<std::string> internal_surfaces_;
    std::vector<std::string> materials_;  // the material with label n has index n - 1
    RawMesh mesh_;
};

}  // namespace

RawMesh read_abaqus(FileReader& reader) {
    return AbaqusReader(reader).read();
}

}  // namespace skerry::mesh
