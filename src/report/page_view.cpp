#include "page.hpp"

namespace ajar::page {

const std::string_view kViewScript = R"js(
// Top view. World x to the right, y up.
const M=D.scene&&D.scene.mechanism,FOOT=(D.scene&&D.scene.robot&&D.scene.robot.footprint_m)||null;
const add=(a,b,s=1)=>[a[0]+s*b[0],a[1]+s*b[1],a[2]+s*b[2]],dot=(a,b)=>a[0]*b[0]+a[1]*b[1]+a[2]*b[2],cross=(a,b)=>[a[1]*b[2]-a[2]*b[1],a[2]*b[0]-a[0]*b[2],a[0]*b[1]-a[1]*b[0]];
function moved(p,q){if(M.type==="slide")return add(p,M.axis,q);const v=add(p,M.point,-1),c=Math.cos(q),s=Math.sin(q),k=M.axis;let r=add([0,0,0],v,c);r=add(r,cross(k,v),s);r=add(r,k,dot(k,v)*(1-c));return add(r,M.point)}
function corners(b){const out=[];for(const i of[-1,1])for(const j of[-1,1])for(const k of[-1,1]){let p=add(b.centre,b.axes[0],i*b.half_extents[0]);p=add(p,b.axes[1],j*b.half_extents[1]);out.push(add(p,b.axes[2],k*b.half_extents[2]))}return out}
function hull(points){const p=points.map(a=>[a[0],a[1]]).sort((a,b)=>a[0]-b[0]||a[1]-b[1]),half=q=>{const h=[];for(const c of q){while(h.length>1){const[a,b]=[h[h.length-2],h[h.length-1]];if((b[0]-a[0])*(c[1]-a[1])-(b[1]-a[1])*(c[0]-a[0])<=0)h.pop();else break}h.push(c)}h.pop();return h};return half(p).concat(half(p.reverse()))}
const seen=b=>{const z=corners(b).map(c=>c[2]);return Math.max(...z)>.05&&Math.min(...z)<2.2};
const WORLD=M?M.world.filter(seen).map(b=>hull(corners(b))):[],LEAF=M?M.leaf.map(corners):[];
function foot(i){const f=FOOT||[-.3,.3,-.25,.25],x=S.base_x[i],y=S.base_y[i],a=S.base_yaw[i];if(!fin(x)||!fin(y)||!fin(a))return null;const c=Math.cos(a),s=Math.sin(a);return[[f[0],f[2]],[f[1],f[2]],[f[1],f[3]],[f[0],f[3]]].map(p=>[x+c*p[0]-s*p[1],y+s*p[0]+c*p[1]])}
const frame=(()=>{const p=[];for(let i=0;i<N;i+=Math.max(1,Math.floor(N/60))){const f=foot(i);if(f)p.push(...f);for(const k of["hand","handle"])if(fin(S[k+"_x"][i]))p.push([S[k+"_x"][i],S[k+"_y"][i]]);if(M&&fin(S.true_q[i]))for(const b of LEAF)for(const c of b)p.push(moved(c,S.true_q[i]))}
 if(M&&M.type==="hinge"&&Math.abs(M.axis[2])>.7)p.push(M.point);if(!p.length)p.push([0,0],[1,1]);const x=p.map(a=>a[0]),y=p.map(a=>a[1]);return[Math.min(...x)-.1,Math.max(...x)+.1,Math.min(...y)-.1,Math.max(...y)+.1]})();
let topBase=null,topFit=null;
function polygon(g,pts,to){g.beginPath();pts.forEach((p,k)=>{const[a,b]=to(p);k?g.lineTo(a,b):g.moveTo(a,b)});g.closePath()}
function path(g,xs,ys,to){g.beginPath();let pen=false;for(let i=0;i<N;i++){if(!fin(xs[i])||!fin(ys[i])){pen=false;continue}const[a,b]=to([xs[i],ys[i]]);pen?g.lineTo(a,b):g.moveTo(a,b);pen=true}g.stroke()}
function robot(g,i,to,strong){const f=foot(i);if(!f)return;polygon(g,f,to);g.globalAlpha=strong?.28:.07;g.fillStyle=css("--c1");g.fill();g.globalAlpha=strong?1:.45;g.strokeStyle=css("--c1");g.lineWidth=strong?2:1;g.stroke();
 const o=to([S.base_x[i],S.base_y[i]]),n=to([(f[1][0]+f[2][0])/2,(f[1][1]+f[2][1])/2]);g.beginPath();g.moveTo(...o);g.lineTo(...n);g.stroke();
 if(strong&&fin(S.hand_x[i])){g.strokeStyle=css("--c2");g.lineWidth=2;g.beginPath();g.moveTo(...o);g.lineTo(...to([S.hand_x[i],S.hand_y[i]]));g.stroke()}g.globalAlpha=1}
function leafAt(g,i,to,strong){if(!fin(S.true_q[i]))return;g.fillStyle=css("--leaf");g.strokeStyle=css("--leaf");g.globalAlpha=strong?.95:.25;
 if(LEAF.length){for(const b of LEAF){polygon(g,hull(b.map(c=>moved(c,S.true_q[i]))),to);g.fill();if(strong){g.lineWidth=1;g.strokeStyle=css("--truth");g.stroke()}}}
 else if(fin(S.centre_x[i])){g.lineWidth=strong?5:2;g.beginPath();g.moveTo(...to([S.centre_x[i],S.centre_y[i]]));g.lineTo(...to([S.handle_x[i],S.handle_y[i]]));g.stroke()}g.globalAlpha=1}
function buildTop(){const canvas=$("top"),f=fit(canvas),w=f.w,h=f.h,c=topBase=document.createElement("canvas"),r=window.devicePixelRatio||1;c.width=canvas.width;c.height=canvas.height;const g=c.getContext("2d");g.setTransform(r,0,0,r,0,0);
 const k=Math.min(w/(frame[1]-frame[0]),h/(frame[3]-frame[2])),ox=(w-k*(frame[1]-frame[0]))/2,oy=(h-k*(frame[3]-frame[2]))/2,to=p=>[ox+k*(p[0]-frame[0]),h-oy-k*(p[1]-frame[2])];topFit={to,w,h};
 g.strokeStyle=css("--line");g.lineWidth=.6;const wx=[frame[0]-ox/k,frame[1]+ox/k],wy=[frame[2]-oy/k,frame[3]+oy/k];for(let v=Math.ceil(wx[0]*2)/2;v<=wx[1];v+=.5){const a=to([v,0])[0];g.beginPath();g.moveTo(a,0);g.lineTo(a,h);g.stroke()}
 for(let v=Math.ceil(wy[0]*2)/2;v<=wy[1];v+=.5){const b=to([0,v])[1];g.beginPath();g.moveTo(0,b);g.lineTo(w,b);g.stroke()}
 g.fillStyle=css("--wall");for(const p of WORLD){polygon(g,p,to);g.fill()}
 for(let n=0;n<5;n++){const a=openRange||[T[0],T[N-1]];if(N)leafAt(g,nearest(a[0]+(a[1]-a[0])*n/4),to,false)}
 const marks=segments.map(s=>s.a);if(N)marks.push(N-1);for(const i of marks)robot(g,i,to,false);
 g.lineWidth=1.5;g.strokeStyle=css("--c1");path(g,S.base_x,S.base_y,to);g.strokeStyle=css("--c2");path(g,S.hand_x,S.hand_y,to);g.strokeStyle=css("--truth");g.lineWidth=2.2;path(g,S.handle_x,S.handle_y,to);
 if(M&&M.type==="hinge"&&Math.abs(M.axis[2])>.7){const[a,b]=to(M.point);g.strokeStyle=css("--bad");g.lineWidth=2;g.beginPath();g.arc(a,b,5,0,7);g.moveTo(a-9,b);g.lineTo(a+9,b);g.moveTo(a,b-9);g.lineTo(a,b+9);g.stroke()}
 g.strokeStyle=g.fillStyle=css("--ink");g.lineWidth=2;const x0=12,y0=h-12;g.beginPath();g.moveTo(x0,y0-5);g.lineTo(x0,y0);g.lineTo(x0+k*.5,y0);g.lineTo(x0+k*.5,y0-5);g.stroke();g.font="12px system-ui,sans-serif";g.fillText("0.5 m",x0+4,y0-6)}
function drawTop(){if(!topBase)return;const g=$("top").getContext("2d");g.save();g.setTransform(1,0,0,1,0,0);g.clearRect(0,0,topBase.width,topBase.height);g.drawImage(topBase,0,0);g.restore();if(!N)return;leafAt(g,cursor,topFit.to,true);robot(g,cursor,topFit.to,true);
 const est=[S.est_x[cursor],S.est_y[cursor]];if(fin(S.hand_x[cursor])&&fin(est[0])){const a=topFit.to([S.hand_x[cursor],S.hand_y[cursor]]),b=topFit.to([S.hand_x[cursor]+.3*est[0],S.hand_y[cursor]+.3*est[1]]);g.strokeStyle=css("--c3");g.lineWidth=3;g.beginPath();g.moveTo(...a);g.lineTo(...b);g.stroke();g.fillStyle=css("--c3");g.beginPath();g.arc(b[0],b[1],4,0,7);g.fill()}}
for(const[color,label]of[["--c1","base: path, footprint"],["--c2","hand"],["--truth","handle, true"],["--leaf","leaf, true"],["--bad","axis, true"],["--c3","believed direction"],["--wall","walls, furniture"]]){const s=el("span"),m=el("i");m.style.borderTopColor="var("+color+")";s.append(m,label);$("toplegend").append(s)}
// Words and figures.
const R=D.result||{},deg=v=>v*180/Math.PI,num=k=>fin(R[k])?R[k]:null,last=k=>{const d=S[k];if(d)for(let i=d.length-1;i>=0;i--)if(fin(d[i]))return d[i];return null};
const openUnit=v=>slide?fmt(v*100,1)+" cm":fmt(deg(v),1)+"°",opened=R.outcome==="opened",type=R.mechanism_type_true||(M&&M.type)||"mechanism";
$("badge").textContent=D.result?(opened?"opened":"stopped"):"broken off";$("badge").classList.add(opened?"good":"bad");
const q=num("opening")!==null?R.opening:last("true_q");
$("headline").textContent=type+(q!==null?" · "+openUnit(q):"")+(num("duration_s")!==null?" · "+fmt(R.duration_s,1)+" s":"")+(num("peak_normal_force_N")!==null?" · peak normal force "+fmt(R.peak_normal_force_N,1)+" N":"");
const sigma=num("curvature_sigma_final_per_m"),kEst=last("curvature_estimated"),kTrue=last("curvature_true"),dErr=num("direction_error_final_rad"),dSig=num("direction_sigma_final_rad");
$("belief").textContent=R.mechanism_type_estimated&&num("open_duration_s")!==null?"The robot believed: "+R.mechanism_type_estimated+(kEst!==null?", curvature "+fmt(kEst,2)+(sigma!==null?" ± "+fmt(2*sigma,2):"")+" 1/m (2σ; true "+fmt(kTrue,2)+")"+(R.mechanism_type_estimated==="hinge"&&kEst>.05?", radius "+fmt(1/kEst,2)+" m":""):"")+(dErr!==null?"; its direction was "+fmt(deg(dErr),1)+"° off"+(dSig!==null?" (2σ "+fmt(deg(2*dSig),1)+"°)":""):"")+".":"";
$("why").textContent=[R.reason?"Ended in phase "+(R.phase||"?")+": "+R.reason+(R.explanation?" – "+R.explanation:""):"",D.cut_off||!D.result?"The record breaks off; this page shows it up to its last complete row.":"",R.version?"version "+R.version+", seed "+R.seed:""].filter(Boolean).join(". ");
const tile=(label,value)=>{const t=el("div",undefined,"tile");t.append(el("b",value),el("span",label));$("tiles").append(t)},show=(k,u,d=1,s=1)=>num(k)===null?"–":fmt(R[k]*s,d)+" "+u;
if(D.result){tile("opened, of the goal",num("opening_fraction")===null?"–":fmt(100*R.opening_fraction,0)+" %");tile("time of opening",show("open_duration_s","s"));tile("peak normal force",show("peak_normal_force_N","N"));tile("normal force after 15 cm",show("late_normal_force_N","N"));tile("peak pull force",show("peak_pull_force_N","N"));
tile("direction error at 20 cm",show("direction_error_20cm_rad","°",1,180/Math.PI));tile("curvature error at 40 cm",show("curvature_error_40cm_per_m","1/m",2));tile("unwanted contacts",String(R.unwanted_contact_count??"–"));tile("smallest clearance",show("min_clearance_m","cm",1,100));tile("real-time factor",show("real_time_factor","×"))}
const notes=$("notes");for(const n of R.notes||[])notes.append(el("p","Note: "+n));if(R.limit_violation_first)notes.append(el("p","Limit: "+R.limit_violation_first));
if((R.unwanted_contacts||[]).length){notes.append(el("h2","Unwanted contacts"));const t=el("table");for(const c of R.unwanted_contacts){const r=el("tr");r.append(el("td",fmt(c.time,2)+" s"),el("td",c.bodies),el("td",fmt(c.force_N,1)+" N"));t.append(r)}notes.append(t)}
const table=el("table");for(const[k,v]of Object.entries(R)){if(v!==null&&typeof v==="object")continue;const r=el("tr");r.append(el("td",k),el("td",v===null?"not applicable":typeof v==="number"?String(+v.toPrecision(6)):String(v)));table.append(r)}$("figures").append(table);$("scenario").textContent=D.scenario;
// Controls.
$("whole").onclick=()=>zoom([T[0],T[N-1]]);$("opening").onclick=()=>openRange&&zoom(openRange);$("opening").disabled=!openRange;
const scrub=$("scrub");if(N){scrub.min=T[0];scrub.max=T[N-1];scrub.oninput=()=>setCursor(nearest(+scrub.value))}
let playing=null;$("play").onclick=()=>{if(playing){cancelAnimationFrame(playing);playing=null;$("play").textContent="play";return}if(!N)return;let t=cursor>=N-1?T[0]:T[cursor],before=performance.now();$("play").textContent="pause";const go=now=>{t+=(now-before)/1000;before=now;if(t>=T[N-1]){setCursor(N-1);playing=null;$("play").textContent="play";return}setCursor(nearest(t));playing=requestAnimationFrame(go)};playing=requestAnimationFrame(go)};
document.addEventListener("keydown",e=>{if(e.target.tagName==="INPUT"||!N)return;if(e.key==="ArrowRight")setCursor(Math.min(N-1,cursor+1));if(e.key==="ArrowLeft")setCursor(Math.max(0,cursor-1))});
function all(){buildTop();for(const p of plots)p.draw();setCursor(cursor)}
window.addEventListener("resize",all);window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change",all);
if(openRange){cursor=nearest(openRange[0]+.6*(openRange[1]-openRange[0]))}
all();
)js";

}  // namespace ajar::page
