/**
 * @class vtkMultiLabelInterfaceMesher
 * @brief one consistent triangle mesh of all interfaces of a multi-label image
 *
 * Delaunay refinement: points are sampled on the interfaces of the indicator functions until the
 * restricted Delaunay facets have the topology of the interfaces and meet the bounds on size, shape
 * and distance. The curves where three or more labels meet are covered with protecting balls first,
 * so that they are edges of the mesh. Each region's boundary is closed by construction. In contrast
 * to vtkSurfaceNets3D and vtkDiscreteFlyingEdges3D the density is independent of the voxels, the
 * triangles have a bounded radius-edge ratio, and soft labels are interpolated.
 *
 * T. K. Dey, F. Janoos, J. A. Levine: Meshing interfaces of multi-label data with Delaunay
 * refinement. Engineering with Computers 28 (2012).
 *
 * Port 0 in: vtkImageData, see vtkMultiLabelImageAlgorithm. A region that reaches the image's box
 * is closed by a flat cap on the box's face. Port 1 in, optional: the balls of
 * vtkMultiLabelCurveProtector for the same image, arrays, TieBreaking and UnseenLabels. Without it
 * this filter extracts and protects the curves itself, with the same result. With it, EdgeSize,
 * BallRadiusScale and JunctionMergeTolerance are those the balls were made with.
 *
 * Output: vtkPolyData in world space; verts (junctions), lines (curve edges) and triangles.
 *
 * Cell arrays:
 * - `BoundaryLabels` (int, 2 components, active scalars): ids of the labels on either side of a
 *   triangle. The background (0) is second, else the first is the lower. The normal points from the
 *   first to the second, also if the direction matrix is a mirror. (-1, -1) for verts and lines.
 * - `PatchId` (int): connected piece of an interface; -1 for verts and lines.
 * - `CurveId` (int): curve of a line; -1 for the others.
 * Point arrays:
 * - `NodeType` (int): 2 on an interface, 3 on a curve, 4 a junction, and 10 more on the box.
 * - `NumberOfLabels` (int): how many labels meet there, the outside being one.
 *
 * vtkSurfaceNetsAtlas takes this output with OutputCurves off only. It pairs the n-th tuple of
 * `BoundaryLabels` with the n-th polygon, but the tuples of verts and lines come first, as VTK
 * numbers cells by kind: verts, lines, polygons. The same holds for any filter that does so.
 *
 * Field data:
 * - `LabelIds`, `LabelNames` and `LabelVolumes`: one entry a label, the background's among them.
 * - The options used, with lengths filled in, named as the properties, and `SmallestDistance`,
 *   below which no two vertices are made; and the grid (`GridDimensions`, `GridSpacing`,
 *   `GridPosition`, `GridDirection`).
 * - Counts, caps included: `VertexCount`, `TriangleCount`, `PatchCount`, `CurveCount`,
 *   `CurveEdgeCount`, `JunctionCount`, `BallCount`, `InsertionCount`;
 *   `HiddenBallCount`: protecting balls left out because another one covers them;
 *   `RelabeledCellCount`: small cells whose label was changed to mend the topology below the
 *   smallest distance; `RelabeledRatioCount`: triangles above the ratio bound that this brought to
 *   light; `OffCurveEdgeCount`: lines with the CurveId -1, where three or more triangles meet off
 *   the extracted curves; `LostCurveEdgeCount`: neighbours on a curve that no edge joins.
 * - Certificate: `CertifiedLabelCount`, `LostLabelCount`, `CertifiedComponentCount`,
 *   `LostComponentCount`, `DiskFailureCount`, `OpenEdgeCount`, `GridCrossingCount`,
 *   `FarCrossingCount`, `MaxCrossingDistance`, `MaxVolumeDifference`. The latter compares each
 *   region with the volume where its label's interpolant is largest, over labels of at least 1000
 *   voxels.
 * - Left undone: `UnresolvedCrossingCount`, `UnresolvedPatchCount`, `UnresolvedSizeCount`,
 *   `UnresolvedDistanceCount`, `UnresolvedRatioCount`, `UnresolvedBallRatioCount`, and
 *   `VertexLimitReached` (0 or 1).
 * - Quality: `MaxRadiusEdgeRatio` (triangles without a ball's vertex), `MaxBallRadiusEdgeRatio`
 *   (with one), `MeanRadiusEdgeRatio`, `MinDihedralAngle` and `MinAngle` in degrees.
 * - Seconds: `TimeIndicators` (of a label map), `TimeField`, `TimeCurves`, `TimeBalls`, `TimeSurface`, `TimeCertificate`.
 *
 * After an error or an abort the output is empty, with its arrays.
 *
 * @sa vtkMultiLabelIndicators vtkMultiLabelCurveExtractor vtkMultiLabelCurveProtector
 * vtkSurfaceNets3D
 */
#ifndef vtkMultiLabelInterfaceMesher_h
#define vtkMultiLabelInterfaceMesher_h

#include "vtkMultiLabelImageAlgorithm.h"
#include "vtkMultiLabelInterfaceMesherModule.h" // for export macro

class vtkImageData;

class VTKMULTILABELINTERFACEMESHER_EXPORT vtkMultiLabelInterfaceMesher
  : public vtkMultiLabelImageAlgorithm
{
public:
  static vtkMultiLabelInterfaceMesher* New();
  vtkTypeMacro(vtkMultiLabelInterfaceMesher, vtkMultiLabelImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** How a segment's crossings with the interfaces are found. */
  enum OracleModes
  {
    Exact,    ///< Walks the image's cells; finds every crossing.
    Bisection ///< The paper's: looks at midpoints only, for comparison.
  };

  ///@{
  /** Protecting balls for the second port. nullptr, or no connection: made by this filter. */
  void SetBallsConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  void SetBallsData(vtkPolyData* balls);
  /** Disconnects the second port. */
  void RemoveBalls() { this->SetInputConnection(1, nullptr); }
  ///@}

  ///@{
  /**
   * Bound on the radius of a triangle's surface Delaunay ball, in world units. Default: 0, which
   * means twice the spacing (the cube root of the voxel's volume).
   */
  vtkSetClampMacro(FacetSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FacetSize, double);
  ///@}

  ///@{
  /**
   * Bound on circumradius / shortest edge of a triangle without a ball's vertex, from 0.6 to 1e6.
   * Default: 1, which means angles of at least 30 degrees.
   */
  vtkSetClampMacro(FacetRadiusEdgeRatio, double, 0.6, 1e6);
  vtkGetMacro(FacetRadiusEdgeRatio, double);
  ///@}

  ///@{
  /**
   * Bound on the distance of a triangle's circumcentre from the interface, and of curve edges from
   * their curve, in world units. Default: 0, which means an eighth of FacetSize.
   */
  vtkSetClampMacro(FacetDistance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FacetDistance, double);
  ///@}

  ///@{
  /**
   * Regions of at least 1000 voxels are meshed finer than FacetDistance where their volume would
   * differ by more than this part from the image's, from 0 to 0.999. 0: off. Default: 0.02.
   */
  vtkSetClampMacro(VolumeTolerance, double, 0.0, 0.999);
  vtkGetMacro(VolumeTolerance, double);
  ///@}

  ///@{
  /**
   * Largest distance of neighbours on a curve, in world units. Default: 0, which means FacetSize.
   * Not used with balls on the second port.
   */
  vtkSetClampMacro(EdgeSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(EdgeSize, double);
  ///@}

  ///@{
  /**
   * Scales the first radii of the balls, without unit, from 0.01 to 1. Default: 1. Not used with
   * balls on the second port.
   */
  vtkSetClampMacro(BallRadiusScale, double, 0.01, 1.0);
  vtkGetMacro(BallRadiusScale, double);
  ///@}

  ///@{
  /**
   * Length at which the search of a crossing stops, in world units. Default: 0, which means a
   * millionth of the spacing.
   */
  vtkSetClampMacro(CrossingTolerance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(CrossingTolerance, double);
  ///@}

  ///@{
  /** Exact or Bisection. Default: Exact. */
  vtkSetClampMacro(OracleMode, int, Exact, Bisection);
  vtkGetMacro(OracleMode, int);
  void SetOracleModeToExact() { this->SetOracleMode(Exact); }
  void SetOracleModeToBisection() { this->SetOracleMode(Bisection); }
  ///@}

  ///@{
  /**
   * Whether the flat caps on the faces of the image's box are part of the output. Default: on. Off
   * leaves the regions there open; field data counts the caps in either case.
   */
  vtkSetMacro(CapBoundary, bool);
  vtkGetMacro(CapBoundary, bool);
  vtkBooleanMacro(CapBoundary, bool);
  ///@}

  ///@{
  /**
   * Whether curve edges and junctions are part of the output, as lines and verts. Default: on.
   * vtkSurfaceNetsAtlas needs it off.
   */
  vtkSetMacro(OutputCurves, bool);
  vtkGetMacro(OutputCurves, bool);
  vtkBooleanMacro(OutputCurves, bool);
  ///@}

  ///@{
  /** Connected components of a label with fewer voxels need not be in the mesh. Default: 30. */
  vtkSetClampMacro(MinimumComponentVoxels, vtkIdType, 1, VTK_ID_MAX);
  vtkGetMacro(MinimumComponentVoxels, vtkIdType);
  ///@}

  ///@{
  /**
   * Largest number of vertices. Refinement stops there with a warning, and its mesh is the output.
   * Default: 20,000,000.
   */
  vtkSetClampMacro(VertexLimit, vtkIdType, 1, 1000000000);
  vtkGetMacro(VertexLimit, vtkIdType);
  ///@}

  ///@{
  /**
   * Precision of the output's points: vtkAlgorithm::SINGLE_PRECISION, DOUBLE_PRECISION, or
   * DEFAULT_PRECISION, which means double. Default: double.
   */
  vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
  vtkGetMacro(OutputPointsPrecision, int);
  ///@}

protected:
  vtkMultiLabelInterfaceMesher();
  ~vtkMultiLabelInterfaceMesher() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMultiLabelInterfaceMesher(const vtkMultiLabelInterfaceMesher&) = delete;
  void operator=(const vtkMultiLabelInterfaceMesher&) = delete;

  void Mesh(vtkImageData* image, vtkPolyData* balls, vtkPolyData* out);

  double FacetSize = 0.0;
  double FacetRadiusEdgeRatio = 1.0;
  double FacetDistance = 0.0;
  double VolumeTolerance = 0.02;
  double EdgeSize = 0.0;
  double BallRadiusScale;
  double CrossingTolerance = 0.0;
  int OracleMode = Exact;
  bool CapBoundary = true;
  bool OutputCurves = true;
  vtkIdType MinimumComponentVoxels = 30;
  vtkIdType VertexLimit = 20000000;
  int OutputPointsPrecision = DOUBLE_PRECISION;
};

#endif
