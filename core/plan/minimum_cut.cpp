#include "core/plan/minimum_cut.h"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

namespace hermite::plan {

namespace {

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using VertexFields = boost::property<
    boost::vertex_index_t, std::size_t,
    boost::property<
        boost::vertex_color_t, boost::default_color_type,
        boost::property<boost::vertex_distance_t, double,
                        boost::property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>>;
using EdgeFields = boost::property<
    boost::edge_capacity_t, double,
    boost::property<boost::edge_residual_capacity_t, double,
                    boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>;
using Graph =
    boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, VertexFields, EdgeFields>;

constexpr double kNothing = 1e-9;

void connect(Graph& graph, std::size_t from, std::size_t to, double capacity) {
  const auto there = boost::add_edge(from, to, graph).first,
             back = boost::add_edge(to, from, graph).first;
  boost::put(boost::edge_capacity, graph, there, capacity);
  boost::put(boost::edge_capacity, graph, back, 0.0);
  boost::put(boost::edge_reverse, graph, there, back);
  boost::put(boost::edge_reverse, graph, back, there);
}

// Returns the vertices that more could flow to: one side of the minimum cut. The colours that the
// algorithm leaves do not show all of it.
std::vector<bool> reached_from(std::size_t source, const Graph& graph) {
  const auto left = boost::get(boost::edge_residual_capacity, graph);
  std::vector<bool> reached(boost::num_vertices(graph));
  std::vector<std::size_t> next{source};
  reached[source] = true;
  while (!next.empty()) {
    const auto [first, end] = boost::out_edges(next.back(), graph);
    next.pop_back();
    for (auto edge = first; edge != end; ++edge) {
      const std::size_t to = boost::target(*edge, graph);
      if (reached[to] || left[*edge] <= kNothing) continue;
      reached[to] = true;
      next.push_back(to);
    }
  }
  return reached;
}

}  // namespace

std::vector<bool> minimum_cut(const std::vector<SideCost>& things,
                              const std::vector<BoundaryCost>& boundaries) {
  const std::size_t count = things.size(), inside = count, outside = count + 1;
  Graph graph(count + 2);
  for (std::size_t i = 0; i < count; ++i) {
    connect(graph, inside, i, things[i].outside);
    connect(graph, i, outside, things[i].inside);
  }
  for (const BoundaryCost& boundary : boundaries)
    connect(graph, boundary.inside, boundary.outside, boundary.cost);
  boost::boykov_kolmogorov_max_flow(graph, inside, outside);
  std::vector<bool> reached = reached_from(inside, graph);
  reached.resize(count);
  return reached;
}

}  // namespace hermite::plan
