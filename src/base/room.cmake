target_link_libraries(swage_base PUBLIC Eigen3::Eigen fmt::fmt
                      PRIVATE TBB::tbb PkgConfig::XXHASH PkgConfig::MUPARSER
                              PkgConfig::SLEEF)
