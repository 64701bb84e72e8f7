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
 * BallRadiusScale and JunctionMergeTolerance are those the balls were made with. Either way balls are made
 * smaller where a sheet bends beside them.
 *
 * Port 0 out: vtkPolyData in world space; verts (junctions), lines (curve edges) and triangles.
 *
 * Cell arrays:
 * - `BoundaryLabels` (int, 2 components, active scalars unless ActiveScalars says otherwise): ids
 *   of the labels on either side of a triangle. The background (0) is second, else the first is the
 *   lower. The normal points from the first to the second, also if the direction matrix is a mirror.
 *   (-1, -1) for verts and lines.
 * - `Label` (int): the first of the two, the region as seen from the background; 0 for verts and
 *   lines.
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
 *   light; `ContactCount`: verts with the CurveId -2, at which sheets meet that touch or are nearer to
 *   each other than twice the smallest distance; `ContactEdgeCount`: lines with the CurveId -2, edges of
 *   three or more triangles at contacts; `OffCurveEdgeCount`: lines with the CurveId -1, where three
 *   or more triangles meet off the extracted curves and contacts; `LostCurveEdgeCount`: neighbours on
 *   a curve that no edge joins.
 * - Certificate: `CertifiedLabelCount`, `LostLabelCount`, `CertifiedComponentCount`,
 *   `LostComponentCount`, `DiskFailureCount` with their places and types (as `NodeType`) in
 *   `DiskFailurePoints` and `DiskFailureTypes`, `OpenEdgeCount`, `GridCrossingCount`, `FarCrossingCount`, `MaxCrossingDistance`, `MaxVolumeDifference`. The latter compares each
 *   region with the volume where its label's interpolant is largest, over labels of at least 1000
 *   voxels.
 * - Left undone: `UnresolvedCrossingCount`, `UnresolvedPatchCount`, `UnresolvedSizeCount`,
 *   `UnresolvedDistanceCount`, `UnresolvedRatioCount`, `UnresolvedBallRatioCount`, and
 *   `VertexLimitReached` (0 or 1).
 * - Quality: `MaxRadiusEdgeRatio` (triangles without a ball's vertex), `MaxBallRadiusEdgeRatio`
 *   (with one), `MeanRadiusEdgeRatio`, `MinDihedralAngle` and `MinAngle` in degrees.
 * - Seconds: `TimeIndicators` (of a label map), `TimeField`, `TimeCurves`, `TimeBalls`,
 *   `TimeSurface`, `TimeCertificate`, `TimeVolume`.
 *
 * Port 1 out, with VolumeMesh on: vtkUnstructuredGrid in world space, the regions filled with
 * tetrahedra of positive volume. Regions that reach the box end at its faces. Two tetrahedra share
 * whole faces; the faces between two labels, or with nothing beyond, are exactly the triangles of
 * port 0 with its caps, and the first points are the points of that surface in its order.
 * - Cell array `Label` (int, active scalars): the label's id.
 * - Field data: `LabelIds`, `LabelNames`, `LabelVolumes` and the options, among them `CellSize`,
 *   `CellRadiusEdgeRatio`, `LabelCellSizes` (id and size), `RemoveSlivers`, `KeepBackground`;
 *   `VertexCount`, `SurfaceVertexCount`, `CellCount`, `InsertionCount`, `AddedVertexCount`;
 *   `SliverCount` tetrahedra below 10 or above 170 degrees after refinement, of which
 *   `UnresolvedSliverCount` are left after `ExchangeCount` steps; `UnresolvedSizeCount`,
 *   `UnresolvedRatioCount` (without a ball's vertex), `UnresolvedBoxCount` (places where the kept
 *   background does not reach the box); `MinDihedralAngle`, `MaxDihedralAngle` in
 *   degrees, `MaxRadiusEdgeRatio` (without a ball's vertex), `MinCellVolume`.
 *
 * After an error or an abort the output is empty, with its arrays; but from VTK 9.2 on VTK itself takes
 * the arrays away after an abort.
 *
 * @sa vtkMultiLabelIndicators vtkMultiLabelCurveExtractor vtkMultiLabelCurveProtector
 * vtkSurfaceNets3D
 */
#ifndef vtkMultiLabelInterfaceMesher_h
#define vtkMultiLabelInterfaceMesher_h

#include "vtkMultiLabelImageAlgorithm.h"
#include "vtkMultiLabelInterfaceMesherModule.h" // for export macro

#include <map>

class vtkImageData;
class vtkUnstructuredGrid;

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

  /** Which cell array of the output is its active scalars. */
  enum ActiveScalarsModes
  {
    BoundaryLabels, ///< Both labels, as vtkSurfaceNets3D has them.
    Label           ///< One value a cell, for hosts that colour by the active scalars.
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

  /**
   * Sensible values of FacetSize for the input, in world units: from one to three spacings, the
   * default in the middle. Known after UpdateInformation; 0 and 0 without an input.
   */
  vtkGetVector2Macro(FacetSizeRange, double);

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

  ///@{
  /** BoundaryLabels or Label. Default: BoundaryLabels; ParaView asks for Label. */
  vtkSetClampMacro(ActiveScalars, int, BoundaryLabels, Label);
  vtkGetMacro(ActiveScalars, int);
  void SetActiveScalarsToBoundaryLabels() { this->SetActiveScalars(BoundaryLabels); }
  void SetActiveScalarsToLabel() { this->SetActiveScalars(Label); }
  ///@}

  ///@{
  /**
   * Whether port 1 gives the regions filled with tetrahedra. It does not change the surface.
   * Default: off.
   */
  vtkSetMacro(VolumeMesh, bool);
  vtkGetMacro(VolumeMesh, bool);
  vtkBooleanMacro(VolumeMesh, bool);
  ///@}

  ///@{
  /**
   * Bound on the circumradius of a tetrahedron, in world units. Default: 0, which means twice
   * FacetSize.
   */
  vtkSetClampMacro(CellSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(CellSize, double);
  ///@}

  ///@{
  /**
   * A CellSize of its own, above 0, for the label with this id; 0 takes it back. Ids that no label
   * has are ignored. The pair of both is for hosts whose tables have numbers of one type.
   */
  void SetLabelCellSize(int id, double size);
  void SetLabelCellSize(const double idAndSize[2]);
  double GetLabelCellSize(int id);
  void RemoveAllLabelCellSizes();
  ///@}

  ///@{
  /** Bound on circumradius / shortest edge of a tetrahedron, from 1 to 1e6. Default: 2. */
  vtkSetClampMacro(CellRadiusEdgeRatio, double, 1.0, 1e6);
  vtkGetMacro(CellRadiusEdgeRatio, double);
  ///@}

  ///@{
  /**
   * Whether tetrahedra with dihedral angles below 15 or above 165 degrees are bettered after
   * refinement, as far as the surface allows. Off: the tetrahedra stay Delaunay. Default: on.
   */
  vtkSetMacro(RemoveSlivers, bool);
  vtkGetMacro(RemoveSlivers, bool);
  vtkBooleanMacro(RemoveSlivers, bool);
  ///@}

  ///@{
  /**
   * Whether the volume has the background's tetrahedra too, with the id 0, so that it fills the
   * image's box. Where the background reaches the box there is still no surface. Default: off.
   */
  vtkSetMacro(KeepBackground, bool);
  vtkGetMacro(KeepBackground, bool);
  vtkBooleanMacro(KeepBackground, bool);
  ///@}

  /** Port 1: the tetrahedra; empty unless VolumeMesh is on. */
  vtkUnstructuredGrid* GetVolumeOutput();

protected:
  vtkMultiLabelInterfaceMesher();
  ~vtkMultiLabelInterfaceMesher() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMultiLabelInterfaceMesher(const vtkMultiLabelInterfaceMesher&) = delete;
  void operator=(const vtkMultiLabelInterfaceMesher&) = delete;

  void Mesh(
    vtkImageData* image, vtkPolyData* balls, vtkPolyData* surface, vtkUnstructuredGrid* volume);

  double FacetSize = 0.0;
  double FacetSizeRange[2] = { 0.0, 0.0 };
  double FacetRadiusEdgeRatio = 1.0;
  double FacetDistance = 0.0;
  double VolumeTolerance = 0.02;
  double EdgeSize = 0.0;
  double BallRadiusScale;
  double CrossingTolerance = 0.0;
  int OracleMode = Exact;
  bool CapBoundary = true;
  bool VolumeMesh = false;
  double CellSize = 0.0;
  std::map<int, double> LabelCellSizes;
  double CellRadiusEdgeRatio = 2.0;
  bool RemoveSlivers = true;
  bool KeepBackground = false;
  bool OutputCurves = true;
  vtkIdType MinimumComponentVoxels = 30;
  vtkIdType VertexLimit = 20000000;
  int OutputPointsPrecision = DOUBLE_PRECISION;
  int ActiveScalars = BoundaryLabels;
};

#endif
