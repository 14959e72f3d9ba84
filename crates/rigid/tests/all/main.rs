//! What holds of `stationary-rigid`, in one binary: what is generic is compiled once.

mod bad_input;
mod body_forces;
mod exponential;
mod facts;
mod forces;
mod free_box;
mod free_top;
mod heavy_tops;
mod jointed;
mod joints;
mod lie_groups;
mod linkages;
mod manifolds;
mod mechanisms;
mod planar;
mod planar_joints;
mod shapes;
mod symmetries;
mod tree;
mod tree_bad_input;
mod tree_driven;
mod tree_loops;
mod tree_motion;
mod tree_prescribed;
